// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/board_system.hpp"

#include <algorithm>

#include "firmware/boards/stm32h7/cpu.hpp"
#include "firmware/boards/stm32h7/timers.hpp"

namespace rosflight::boards::stm32h7 {

void BoardSystem::start_sensors() {
  const std::uint32_t masked = mask_bus();
  for (const BoardSensor& each : sensors_) {
    if (each.driver != nullptr) each.driver->start(how_, clock_.now());
  }
  unmask_bus(masked);
  const hal::Time end = clock_.now() + wait_;
  const auto starting = [this] {
    const auto last = how_ == parts::Start::kWarm ? sensors_.begin() + 1 : sensors_.end();
    return std::any_of(sensors_.begin(), last, [](const BoardSensor& each) {
      return each.started != nullptr && each.driver->state() == parts::PartState::kStarting;
    });
  };
  while (starting() && clock_.now() < end) wait_for_interrupt();
}

void BoardSystem::step(hal::Time now) {
  for (const BoardSensor& each : sensors_) {
    if (each.driver != nullptr) each.driver->step(now);
  }
}

std::uint16_t BoardSystem::sensor_errors() const {
  std::uint32_t sum = 0;
  for (const BoardSensor& each : sensors_) {
    const bool counts =
        each.driver != nullptr && (each.started != nullptr || each.driver->was_well());
    if (counts) sum += each.driver->errors();
  }
  return static_cast<std::uint16_t>(std::min<std::uint32_t>(sum, 0xFFFF));
}

/// Of those that are waited for, which come first.
const char* BoardSystem::sensor_message(std::size_t index, bool& ok) const {
  if (index >= sensors_.size() || sensors_[index].started == nullptr) return nullptr;
  const parts::Driver& driver = *sensors_[index].driver;
  ok = driver.state() != parts::PartState::kFailed;
  const char* const message = driver.message();
  return message[0] != 0 ? message : sensors_[index].started;
}

void BoardSystem::start_watchdog() {
  Watchdog::start(static_cast<std::uint32_t>(kMaxPass.count()),
                  static_cast<std::uint32_t>(2 * hal::to_ms(kMaxPass)));
  watched_ = true;
}

void BoardSystem::feed_watchdog() {
  if (watched_) Watchdog::feed();
}

void BoardSystem::reset(bool /*to_bootloader*/) {
  reset_processor();
}

}  // namespace rosflight::boards::stm32h7
