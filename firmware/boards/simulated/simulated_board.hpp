// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/boards/common/simulated_peripherals.hpp"
#include "firmware/hal/roles.hpp"

/// A board made of memory: every role in process, driven from outside. Used by the simulation, by
/// replay and by tests; faults are switched on here, never in the core.
namespace rosflight::boards {

class SimulatedClock final : public hal::Clock {
 public:
  hal::Time now() const override { return now_; }
  void set(hal::Time now) { now_ = now; }

 private:
  hal::Time now_{};
};

/// Bytes that survive the firmware. Starts blank (0xFF). Power can be cut after any number of
/// bytes.
class SimulatedStorage final : public hal::Storage {
 public:
  explicit SimulatedStorage(std::size_t size = 16384) : bytes_(size, 0xFF) {}
  std::size_t size() const override { return bytes_.size(); }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override;
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override;
  bool flush() override { return !power_cut_; }

  /// Only the next `count` bytes still reach the medium; write() then reports failure.
  void cut_power_after(std::size_t count) { bytes_left_ = count; }
  void restore_power();
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  void set_bytes(std::vector<std::uint8_t> bytes) { bytes_ = std::move(bytes); }

 private:
  std::vector<std::uint8_t> bytes_;
  std::optional<std::size_t> bytes_left_;
  bool power_cut_{false};
};

class SimulatedSystem final : public hal::System {
 public:
  void start_sensors() override { started_ = true; }
  std::uint16_t sensor_errors() const override { return sensor_errors_; }
  const char* sensor_message(std::size_t index, bool& ok) const override;
  const char* sensor_change(bool& ok) override;
  void reset(bool to_bootloader) override;
  void feed_watchdog() override { ++passes_; }
  /// Simulated time stands still during a pass: none is used, unless a test says so.
  hal::Time busy_time() const override { return busy_ += work_; }
  bool shares_processor() const override { return false; }

  bool sensors_started() const { return started_; }
  std::uint64_t passes() const { return passes_; }
  bool reset_requested() const { return reset_requested_; }
  bool to_bootloader() const { return to_bootloader_; }
  /// The owner has restarted the firmware.
  void acknowledge_reset() { reset_requested_ = false; }
  /// From now on this much processor time passes between two calls of busy_time().
  void set_work(hal::Time work) { work_ = work; }
  void set_sensor_errors(std::uint16_t count) { sensor_errors_ = count; }
  void add_message(std::string text, bool ok) { messages_.push_back({std::move(text), ok}); }
  /// Reported after the start-up report.
  void add_change(std::string text, bool ok) { changes_.push_back({std::move(text), ok}); }

 private:
  struct Message {
    std::string text;
    bool ok;
  };
  std::vector<Message> messages_, changes_;
  std::size_t changes_reported_{0};
  std::uint64_t passes_{0};
  mutable hal::Time busy_{};
  hal::Time work_{};
  std::uint16_t sensor_errors_{0};
  bool started_{false};
  bool reset_requested_{false};
  bool to_bootloader_{false};
};

/// A serial port into memory: what was written can be taken, what shall be read can be put.
class MemorySerial final : public hal::Serial {
 public:
  explicit MemorySerial(std::size_t capacity = 4096) : capacity_{capacity} {}
  bool open(std::uint32_t baud, std::uint8_t device) override;
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override;
  std::size_t writable() const override { return capacity_ - sent_.size(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override;

  std::vector<std::uint8_t> take_sent();
  void put(const std::uint8_t* data, std::size_t size);
  std::uint32_t baud() const { return baud_; }
  std::size_t dropped() const { return dropped_; }

 private:
  std::size_t capacity_;
  std::vector<std::uint8_t> sent_;
  std::vector<std::uint8_t> incoming_;
  std::size_t taken_{0};
  std::size_t dropped_{0};
  std::uint32_t baud_{0};
};

struct SimulatedBoard {
  SimulatedClock clock;
  SimulatedSystem system;
  SimulatedStorage storage;
  SimulatedBackup backup;
  SimulatedLeds leds;
  SimulatedOutputs outputs;
  SimulatedReceiver receiver;
  SimulatedBattery battery;
  Mailbox<hal::ImuSample> imu;
  Mailbox<hal::MagSample> mag;
  Mailbox<hal::BaroSample> baro;
  Mailbox<hal::DiffPressureSample> diff_pressure;
  Mailbox<hal::RangeSample> range;
  Mailbox<hal::GnssSample> gnss;

  /// The board as the firmware sees it, with the given wire to the companion.
  hal::Board roles(hal::Serial& serial);
};

}  // namespace rosflight::boards
