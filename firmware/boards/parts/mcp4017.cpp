// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/mcp4017.hpp"

#include <algorithm>

namespace rosflight::boards::parts {

Mcp4017::Mcp4017(Port& port, float supply_V)
    : Driver{"MCP4017"}, port_{port}, period_{hal::milliseconds(1000)}, wanted_{wiper(supply_V)} {}

std::uint8_t Mcp4017::wiper(float supply_V) {
  const float v = std::min(std::max(supply_V, 4.8f), 8.2f);
  const float n = ((-0.82601912f * v + 21.03465037f) * v - 193.55466392f) * v + 628.13007632f;
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative
  return static_cast<std::uint8_t>(std::min(std::max(n, 0.0f), 93.0f) + 0.5f);
}

/// A warm start reads before it writes: servos keep their supply.
bool Mcp4017::begin(Start how, Time now) {
  if (on_bus_) return false;
  written_ = how == Start::kWarm;
  period_.restart(now + hal::milliseconds(1000));
  return true;
}

void Mcp4017::step_start(Time /*now*/) {
  if (on_bus_) return;
  if (written_) {
    exchange(0, 1);
  } else {
    exchange(1, 0);
  }
}

void Mcp4017::step_running(Time now) {
  if (!on_bus_ && period_.due(now)) exchange(0, 1);
}

void Mcp4017::exchange(std::size_t out, std::size_t in) {
  transfer_ = {&wanted_, out, &found_, in, this};
  on_bus_ = port_.start(transfer_);
}

void Mcp4017::transfer_done(Transfer& transfer, TransferResult result, Time end) {
  on_bus_ = false;
  if (state() == PartState::kFailed) return;
  if (state() == PartState::kStarting && result != TransferResult::kDone) {
    fail(end).add(result == TransferResult::kNoAnswer ? "no answer" : "bus fault");
  } else if (good(result, end)) {
    if (transfer.in_count == 0) {
      written_ = true;
    } else if (found_ != wanted_) {
      fail(end).add("wiper is ").number(found_).add(", written ").number(wanted_);
    } else {
      started();
      well();
    }
  }
}

}  // namespace rosflight::boards::parts
