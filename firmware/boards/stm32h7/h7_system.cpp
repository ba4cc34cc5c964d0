// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/h7_system.hpp"

#include <algorithm>

#include "firmware/boards/stm32h7/backup_domain.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"
#include "firmware/boards/stm32h7/timers.hpp"

namespace rosflight::boards::stm32h7 {

void H7System::start(std::size_t first, std::size_t end) {
  const std::uint32_t masked = mask_bus();
  for (std::size_t k = first; k < end; ++k) {
    if (sensors_[k].driver != nullptr) sensors_[k].driver->start(how_, clock_.now());
  }
  unmask_bus(masked);
}

void H7System::start_sensors() {
  start(1, sensors_.size());
  const hal::Time end = clock_.now() + wait_;
  const auto starting = [this] {
    const auto last = how_ == parts::Start::kWarm ? sensors_.begin() + 1 : sensors_.end();
    return std::any_of(sensors_.begin(), last, [](const SystemSensor& each) {
      return each.started != nullptr && each.driver->state() == parts::PartState::kStarting;
    });
  };
  while (starting() && clock_.now() < end) wait_for_interrupt();
  for (std::size_t k = 0; k < sensors_.size(); ++k) {
    const SystemSensor& each = sensors_[k];
    reported_[k].failed = each.started != nullptr && each.driver->failure_announced();
  }
}

void H7System::step(hal::Time now) {
  for (const SystemSensor& each : sensors_) {
    if (each.driver != nullptr) each.driver->step(now);
  }
}

std::uint16_t H7System::sensor_errors() const {
  std::uint32_t sum = 0;
  for (const SystemSensor& each : sensors_) {
    const bool counts =
        each.driver != nullptr && (each.started != nullptr || each.driver->was_well());
    if (counts) sum += each.driver->errors();
  }
  return static_cast<std::uint16_t>(std::min<std::uint32_t>(sum, 0xFFFF));
}

/// Messages of the sensors that the start waits for, which come first.
const char* H7System::sensor_message(std::size_t index, bool& ok) const {
  if (index >= sensors_.size() || sensors_[index].started == nullptr) return nullptr;
  const parts::Driver& driver = *sensors_[index].driver;
  ok = driver.state() != parts::PartState::kFailed;
  const char* const message = driver.message();
  return message[0] != 0 ? message : sensors_[index].started;
}

const char* H7System::sensor_change(bool& ok) {
  constexpr hal::Time kBetweenTexts = hal::milliseconds(1000);
  for (std::size_t k = 0; k < sensors_.size(); ++k) {
    const SystemSensor& each = sensors_[k];
    if (each.driver == nullptr || (each.started == nullptr && !each.driver->answered())) continue;
    Reported& reported = reported_[k];
    const bool failed = each.driver->failure_announced();
    if (failed == reported.failed) continue;
    const hal::Time now = clock_.now();
    if (now - reported.at < kBetweenTexts) continue;
    reported = {failed, now};
    ok = !failed;
    return each.driver->message();
  }
  return nullptr;
}

void H7System::start_watchdog() {
  Watchdog::start(static_cast<std::uint32_t>(kMaxPass.count()),
                  static_cast<std::uint32_t>(2 * hal::to_ms(kMaxPass)));
  watched_ = true;
}

void H7System::feed_watchdog() {
  if (watched_) Watchdog::feed();
}

void H7System::reset(bool to_bootloader) {
  if (to_bootloader) request_bootloader();
  reset_processor();
}

}  // namespace rosflight::boards::stm32h7
