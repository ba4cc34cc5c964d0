// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/driver.hpp"

#include "firmware/boards/parts/setup.hpp"

namespace rosflight::boards::parts {

void Driver::start(Start how, Time now) {
  how_ = how;
  begun_ = now;
  failures_in_a_row_ = 0;
  well_ = false;
  if (begin(how, now)) {
    state_.store(PartState::kStarting, std::memory_order_release);
  } else {
    retry_ = how;
    retry_at_ = now;
    state_.store(PartState::kFailed, std::memory_order_release);
  }
}

void Driver::step(Time now) {
  switch (state()) {
    case PartState::kOff:
      break;
    case PartState::kStarting:
      step_start(now);
      break;
    case PartState::kRunning:
      step_running(now);
      break;
    case PartState::kFailed:
      if (now >= retry_at_) start(retry_, now);
  }
}

void Driver::started() {
  state_.store(PartState::kRunning, std::memory_order_release);
}

void Driver::well() {
  if (well_) return;
  well_ = true;
  was_well_.store(true, std::memory_order_relaxed);
  failures_in_a_row_ = 0;
  Text{message_.data(), message_.size()}.add(name_).add(": ok");
  if (announcements() == 0 || failure_announced_) announce();
  failure_announced_ = false;
}

bool Driver::step_setup(Setup& setup, Time now) {
  setup.step(now);
  if (setup.status() == Setup::Status::kFailed) {
    Text text = fail(now);
    setup.describe(text);
  }
  return setup.status() == Setup::Status::kDone;
}

/// The announcement comes before the text is complete; the main loop cannot look in between.
Text Driver::fail(Time now) {
  count_error();
  retry_ = well_ ? Start::kWarm : Start::kCold;
  retry_at_ = well_ || how_ == Start::kWarm ? now : now + kRetry;
  well_ = false;
  state_.store(PartState::kFailed, std::memory_order_release);
  if (!failure_announced_) announce();
  failure_announced_ = true;
  Text text{message_.data(), message_.size()};
  text.add(name_).add(": ");
  return text;
}

bool Driver::good(TransferResult result, Time now) {
  if (result == TransferResult::kDone) {
    failures_in_a_row_ = 0;
    return true;
  }
  count_error();
  const bool alive = state() == PartState::kStarting || state() == PartState::kRunning;
  if (!alive || ++failures_in_a_row_ < kFailuresInARow) return false;
  fail(now).add(result == TransferResult::kNoAnswer   ? "no answer"
                : result == TransferResult::kBusFault ? "bus fault"
                                                      : "bus stuck");
  return false;
}

void Driver::count_error() {
  if (failure_announced()) return;
  const std::uint16_t errors = errors_.load(std::memory_order_relaxed);
  if (errors != 0xFFFFu) {
    errors_.store(static_cast<std::uint16_t>(errors + 1), std::memory_order_relaxed);
  }
}

}  // namespace rosflight::boards::parts
