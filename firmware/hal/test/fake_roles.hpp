// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <vector>

#include "firmware/hal/roles.hpp"

/// The least that keeps each contract: what to start from when a board is new. Sources are queues
/// here, where the simulated board has mailboxes; both are allowed.
namespace rosflight::hal::fake {

class ManualClock final : public Clock {
 public:
  Time now() const override { return now_; }
  void pass(Time time) { now_ += time; }

 private:
  Time now_{};
};

template <class Sample, class Role = Source<Sample>>
class Queue : public Role {
 public:
  virtual ~Queue() = default;
  bool poll(Sample& sample) override {
    if (waiting_.empty()) return false;
    sample = waiting_.front();
    waiting_.pop_front();
    return true;
  }
  void deliver(const Sample& sample) { waiting_.push_back(sample); }

 private:
  std::deque<Sample> waiting_;
};

/// Has no PPM input.
class SbusReceiver final : public Queue<RcFrame, Receiver> {
 public:
  bool start(ReceiverType type) override { return type == ReceiverType::kSbus; }
};

class DividerBattery final : public Queue<BatterySample, Battery> {
 public:
  bool poll(BatterySample& sample) override {
    if (!Queue::poll(sample)) return false;
    sample.voltage_V *= voltage_;
    sample.current_A *= current_;
    return true;
  }
  void set_multipliers(float voltage, float current) override {
    if (voltage != 0.0f) voltage_ = voltage;
    if (current != 0.0f) current_ = current;
  }

 private:
  float voltage_{11.215f};
  float current_{60.5f};
};

class Loop final : public Serial {
 public:
  bool open(std::uint32_t /*baud*/, std::uint8_t device) override { return device == 0; }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t /*qos*/) override {
    if (size > writable()) return false;
    out_.insert(out_.end(), data, data + size);
    return true;
  }
  std::size_t writable() const override { return 512 - out_.size(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    const std::size_t n = std::min(capacity, in_.size());
    std::copy_n(in_.begin(), n, data);
    in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(n));
    return n;
  }
  void deliver(const std::vector<std::uint8_t>& bytes) {
    in_.insert(in_.end(), bytes.begin(), bytes.end());
  }
  std::vector<std::uint8_t> sent() {
    std::vector<std::uint8_t> bytes;
    bytes.swap(out_);
    return bytes;
  }

 private:
  std::deque<std::uint8_t> in_;
  std::vector<std::uint8_t> out_;
};

/// Eight pins whose pulses last whole microseconds, or that are levels.
class PwmOutputs final : public Outputs {
 public:
  static constexpr std::size_t kPins = 8;
  bool configure(const OutputRates& rates_hz) override {
    disable();
    running_ = true;
    for (std::size_t k = 0; k < kPins; ++k) level_[k] = rates_hz[k] == 0.0f;
    return std::all_of(rates_hz.begin(), rates_hz.end(),
                       [](float rate) { return rate >= 0.0f && rate <= 490.0f; });
  }
  void write(const OutputValues& values) override {
    if (!running_) return;
    for (std::size_t k = 0; k < kPins; ++k) {
      const float clamped = std::isnan(values[k]) ? 0.0f : std::clamp(values[k], 0.0f, 1.0f);
      const float driven = !level_[k] ? clamped : clamped >= kHighLevel ? 1.0f : 0.0f;
      pulse_us_[k] = 1000 + static_cast<int>(1000.0f * driven);
    }
  }
  void disable() override {
    running_ = false;
    pulse_us_.fill(1000);
  }
  float driven(std::size_t k) const { return static_cast<float>(pulse_us_[k] - 1000) / 1000.0f; }

 private:
  std::array<int, kPins> pulse_us_{1000, 1000, 1000, 1000, 1000, 1000, 1000, 1000};
  std::array<bool, kPins> level_{};
  bool running_{false};
};

class Chip final : public Storage {
 public:
  std::size_t size() const override { return bytes_.size(); }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override {
    if (!inside(offset, count)) return false;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), count, data);
    return true;
  }
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override {
    if (!inside(offset, count)) return false;
    std::copy_n(data, count, bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
    return true;
  }
  bool flush() override { return true; }

 private:
  bool inside(std::size_t offset, std::size_t count) const {
    return offset <= size() && count <= size() - offset;
  }
  std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(2048, 0);
};

class Registers final : public BackupMemory {
 public:
  bool read(std::uint8_t* data, std::size_t count) override {
    if (count > kSize) return false;
    std::memcpy(data, bytes_.data(), count);
    return true;
  }
  bool write(const std::uint8_t* data, std::size_t count) override {
    if (count > kSize) return false;
    std::memcpy(bytes_.data(), data, count);
    return true;
  }
  void clear() override { bytes_.fill(0); }

 private:
  std::array<std::uint8_t, kSize> bytes_{};
};

class Lamps final : public Leds {
 public:
  void set(Led led, bool on) override { on_[static_cast<std::size_t>(led)] = on; }
  bool lit(Led led) const { return on_[static_cast<std::size_t>(led)]; }

 private:
  std::array<bool, 2> on_{};
};

/// One good sensor and one bad.
class Processor final : public System {
 public:
  void start_sensors() override { sensors_started = true; }
  std::uint16_t sensor_errors() const override { return 1; }
  const char* sensor_message(std::size_t index, bool& ok) const override {
    ok = index == 0;
    return index == 0 ? "IMU found" : (index == 1 ? "Barometer silent" : nullptr);
  }
  void reset(bool to_bootloader) override {
    reset_asked = true;
    bootloader_asked = to_bootloader;
  }
  void feed_watchdog() override { used_ += microseconds(100); }
  Time busy_time() const override { return used_; }
  bool shares_processor() const override { return false; }

  bool sensors_started{false};
  bool reset_asked{false};
  bool bootloader_asked{false};

 private:
  Time used_{};
};

}  // namespace rosflight::hal::fake
