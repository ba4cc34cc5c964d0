// SPDX-License-Identifier: BSD-3-Clause
// Memory of the firmware: size of one object with its link adapter, and allocations on the
// firmware's side of a whole flight after construction.
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "flight/autopilot/in_process_autopilot.hpp"
#include "flight/flight.hpp"
#include "link/mavlink/mavlink_codec.hpp"
#include "test_support/allocations.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file

/// Counts while the firmware runs.
class CountingAutopilot final : public flight::InProcessAutopilot {
 public:
  CountingAutopilot(flight::CableLink& link, std::size_t& allocations)
      : InProcessAutopilot{link}, allocations_{allocations} {}
  const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                const hal::RcFrame* rc) override {
    const std::size_t before = test_support::allocations();
    const hal::OutputValues& outputs = InProcessAutopilot::step(t, samples, rc);
    allocations_ += test_support::allocations() - before;
    return outputs;
  }

 private:
  std::size_t& allocations_;
};

}  // namespace

int main() {
  try {
    const auto setup = std::make_unique<flight::FlightSetup>(flight::FlightChoice{});
    std::size_t allocations = 0;
    flight::FlightParts parts;
    parts.autopilot = [&allocations](flight::CableLink& link) {
      return std::make_unique<CountingAutopilot>(link, allocations);
    };
    const auto flight = std::make_unique<flight::Flight>(*setup, std::move(parts));
    flight->run();
    if (flight->runner().stage() != flight::Stage::kDone) {
      std::fprintf(stderr, "sizes: the flight failed: %s\n", flight->runner().failure().c_str());
      return 1;
    }
    std::cout << nlohmann::ordered_json{{"firmware.object_bytes",
                                         sizeof(core::Firmware) + sizeof(link::MavlinkCodec)},
                                        {"firmware.heap_allocations", allocations}}
              << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sizes: %s\n", e.what());
    return 1;
  }
}
