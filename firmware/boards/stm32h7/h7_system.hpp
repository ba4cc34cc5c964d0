// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/driver.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::stm32h7 {

/// A sensor of the board, as the start-up report lists it.
struct SystemSensor {
  parts::Driver* driver{};
  /// What the start-up report contains of it when it runs and has no message of its own. nullptr: it need not
  /// be connected, so it is not waited for, its failures are reported once it has sent something, and its errors count
  /// from its first sample on.
  const char* started{};
};

/// The processor and the sensors of a board as a whole.
class H7System final : public hal::System {
 public:
  static constexpr std::size_t kMaxSensors = 6;
  /// A longer pass of the main loop counts as hanging; the chip resets by itself after twice the time.
  static constexpr hal::Time kMaxPass = hal::milliseconds(50);
  using Sensors = std::array<SystemSensor, kMaxSensors>;

  H7System(const hal::Clock& clock, parts::Start how) : clock_{clock}, how_{how} {}

  /// The sensors in the order of the start-up report, the IMU first; unused ones are empty.
  /// @param wait  longest wait for them at a cold start. Those that need longer follow while it flies.
  void set_sensors(const Sensors& sensors, hal::Time wait) {
    sensors_ = sensors;
    wait_ = wait;
  }

  /// Starts the IMU, whose bus is open: it sets itself up while the core reads its parameters. The others come
  /// later, because a measurement that a reset of the chip left behind must have ended.
  void start_imu() { start(0, 1); }
  /// Starts the others and waits until the sensors run or have failed. After a warm start only for the IMU: without it there
  /// is nothing to fly with.
  void start_sensors() override;
  std::uint16_t sensor_errors() const override;
  const char* sensor_message(std::size_t index, bool& ok) const override;
  /// At most one text per second of each sensor, whatever a bad contact does.
  const char* sensor_change(bool& ok) override;
  void reset(bool to_bootloader) override;
  void feed_watchdog() override;
  /// From now on a pass of the main loop may take kMaxPass.
  void start_watchdog();
  /// Time not slept.
  hal::Time busy_time() const override { return clock_.now() - slept_; }
  bool shares_processor() const override { return false; }

  void add_slept(hal::Time time) { slept_ += time; }
  /// Bus context, once per tick.
  void step(hal::Time now);

 private:
  void start(std::size_t first, std::size_t end);

  const hal::Clock& clock_;
  Sensors sensors_{};
  /// What the start-up report or sensor_change() has reported of a sensor.
  struct Reported {
    bool failed{false};
    hal::Time at{hal::milliseconds(-1000)};
  };
  std::array<Reported, kMaxSensors> reported_{};
  hal::Time wait_{};
  parts::Start how_;
  hal::Time slept_{};
  bool watched_{false};
};

}  // namespace rosflight::boards::stm32h7
