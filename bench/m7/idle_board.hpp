// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstring>

#include "firmware/boards/common/simulated_peripherals.hpp"
#include "firmware/hal/roles.hpp"

/// A board that does nothing: each role keeps its contract's letter and costs as little as it can.
namespace rosflight::bench {

class IdleClock final : public hal::Clock {
 public:
  hal::Time now() const override { return now_; }
  void set(hal::Time now) { now_ = now; }

 private:
  hal::Time now_{};
};

template <class Sample, class Role = hal::Source<Sample>>
using Slot = boards::Mailbox<Sample, Role>;

class IdleReceiver final : public Slot<hal::RcFrame, hal::Receiver> {
 public:
  bool start(hal::ReceiverType /*type*/) override { return true; }
};

class IdleBattery final : public Slot<hal::BatterySample, hal::Battery> {
 public:
  void set_multipliers(float /*voltage*/, float /*current*/) override {}
};

/// Takes every frame; brings what was put.
class IdleSerial final : public hal::Serial {
 public:
  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
  bool write(const std::uint8_t* /*data*/, std::size_t size, std::uint8_t /*qos*/) override {
    sent_ += size;
    return true;
  }
  std::size_t writable() const override { return 4096; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    const std::size_t count = std::min(capacity, size_ - taken_);
    std::memcpy(data, &bytes_[taken_], count);  // a driver's copy, not the firmware's work
    taken_ += count;
    return count;
  }
  void put(const std::uint8_t* data, std::size_t size) {
    if (taken_ == size_) taken_ = size_ = 0;
    for (std::size_t k = 0; k < size && size_ < bytes_.size(); ++k) bytes_[size_++] = data[k];
  }
  std::size_t sent() const { return sent_; }

 private:
  std::array<std::uint8_t, 1024> bytes_{};
  std::size_t size_{0};
  std::size_t taken_{0};
  std::size_t sent_{0};
};

class IdleOutputs final : public hal::Outputs {
 public:
  bool configure(const hal::OutputRates& /*rates_hz*/) override { return true; }
  void write(const hal::OutputValues& /*values*/) override {}
  void disable() override {}
};

/// Memory: arming stores changed parameters first, and reads them back.
class IdleStorage final : public hal::Storage {
 public:
  std::size_t size() const override { return bytes_.size(); }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override {
    if (offset > bytes_.size() || count > bytes_.size() - offset) return false;
    for (std::size_t k = 0; k < count; ++k) data[k] = bytes_[offset + k];
    return true;
  }
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override {
    if (offset > bytes_.size() || count > bytes_.size() - offset) return false;
    for (std::size_t k = 0; k < count; ++k) bytes_[offset + k] = data[k];
    return true;
  }
  bool flush() override { return true; }

 private:
  std::array<std::uint8_t, 16384> bytes_{};
};

class IdleBackup final : public hal::BackupMemory {
 public:
  bool read(std::uint8_t* /*data*/, std::size_t /*count*/) override { return false; }
  bool write(const std::uint8_t* /*data*/, std::size_t /*count*/) override { return false; }
  void clear() override {}
};

class IdleLeds final : public hal::Leds {
 public:
  void set(hal::Led /*led*/, bool /*on*/) override {}
};

class IdleSystem final : public hal::System {
 public:
  void start_sensors() override {}
  std::uint16_t sensor_errors() const override { return 0; }
  const char* sensor_message(std::size_t /*index*/, bool& /*ok*/) const override { return nullptr; }
  void reset(bool /*to_bootloader*/) override {}
  void feed_watchdog() override {}
  hal::Time busy_time() const override { return {}; }
  bool shares_processor() const override { return false; }
};

struct IdleBoard {
  IdleClock clock;
  IdleSystem system;
  IdleSerial serial;
  IdleStorage storage;
  IdleBackup backup;
  IdleLeds leds;
  IdleOutputs outputs;
  IdleReceiver receiver;
  IdleBattery battery;
  Slot<hal::ImuSample> imu;
  Slot<hal::MagSample> mag;
  Slot<hal::BaroSample> baro;
  Slot<hal::DiffPressureSample> diff_pressure;
  Slot<hal::RangeSample> range;
  Slot<hal::GnssSample> gnss;
  hal::Board roles() {
    return {clock,   system, serial, storage, backup,        leds,  outputs, receiver,
            battery, imu,    mag,    baro,    diff_pressure, range, gnss};
  }
};

}  // namespace rosflight::bench
