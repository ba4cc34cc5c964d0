// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>
#include <ctime>

#include "firmware/boards/linux/linux_clock.hpp"

namespace rosflight::boards {

/// The process as a processor. A reset is a request: the program sees it when the pass is over,
/// builds the firmware again and calls restarted(); storage and backup memory stay.
///
/// The watchdog bites nobody here. It counts the times it would have: passes that came more than
/// kWatchdog after the one before.
class LinuxSystem final : public hal::System {
 public:
  static constexpr hal::Time kWatchdog = hal::milliseconds(100);

  explicit LinuxSystem(const hal::Clock& clock) : clock_{clock} {}

  void start_sensors() override { started_ = true; }
  std::uint16_t sensor_errors() const override { return 0; }
  /// Simulated sensors always start; there is nothing to report.
  const char* sensor_message(std::size_t /*index*/, bool& /*ok*/) const override { return nullptr; }
  void reset(bool to_bootloader) override {
    reset_requested_ = true;
    to_bootloader_ = to_bootloader;
  }
  void feed_watchdog() override {
    const hal::Time now = clock_.now();
    if (passes_in_boot_++ > 0 && now - last_pass_ > kWatchdog) ++watchdog_count_;
    last_pass_ = now;
    ++passes_;
  }

  /// Time of the calling thread, so that waiting for other programs does not count.
  hal::Time busy_time() const override {
    timespec used{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return std::chrono::duration_cast<hal::Time>(std::chrono::seconds{used.tv_sec} +
                                                 std::chrono::nanoseconds{used.tv_nsec});
  }
  bool shares_processor() const override { return true; }

  bool sensors_started() const { return started_; }
  std::uint64_t passes() const { return passes_; }
  std::uint64_t watchdog_count() const { return watchdog_count_; }
  bool reset_requested() const { return reset_requested_; }
  bool to_bootloader() const { return to_bootloader_; }
  void restarted() {
    reset_requested_ = started_ = false;
    passes_in_boot_ = 0;
  }

 private:
  const hal::Clock& clock_;
  hal::Time last_pass_{};
  std::uint64_t passes_{0};
  std::uint64_t passes_in_boot_{0};
  std::uint64_t watchdog_count_{0};
  bool started_{false};
  bool reset_requested_{false};
  bool to_bootloader_{false};
};

}  // namespace rosflight::boards
