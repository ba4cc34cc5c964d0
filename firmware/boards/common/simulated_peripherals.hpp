// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "base/eigen.hpp"
#include "firmware/hal/roles.hpp"

/// Peripherals of boards without hardware around them: a simulated vehicle puts samples in and
/// looks at what comes out.
namespace rosflight::boards {

/// Holds one sample until it is polled; a newer one replaces it.
template <class Sample, class Role = hal::Source<Sample>>
class Mailbox : public Role {
 public:
  virtual ~Mailbox() = default;
  bool poll(Sample& sample) override {
    if (!full_) return false;
    sample = sample_;
    full_ = false;
    return true;
  }
  bool waiting() const { return full_; }
  void put(const Sample& sample) {
    sample_ = sample;
    full_ = true;
  }

 private:
  Sample sample_{};
  bool full_{false};
};

class SimulatedReceiver final : public Mailbox<hal::RcFrame, hal::Receiver> {
 public:
  bool start(hal::ReceiverType type) override {
    type_ = type;
    return true;
  }
  hal::ReceiverType type() const { return type_; }

 private:
  hal::ReceiverType type_{hal::ReceiverType::kSbus};
};

/// Scales what is put in, as a divider in front of a converter would.
class SimulatedBattery final : public Mailbox<hal::BatterySample, hal::Battery> {
 public:
  bool poll(hal::BatterySample& sample) override {
    if (!Mailbox::poll(sample)) return false;
    sample.voltage_V *= voltage_;
    sample.current_A *= current_;
    return true;
  }
  void set_multipliers(float voltage, float current) override {
    if (voltage != 0.0f) voltage_ = voltage;
    if (current != 0.0f) current_ = current;
  }

 private:
  float voltage_{1.0f};
  float current_{1.0f};
};

class SimulatedOutputs final : public hal::Outputs {
 public:
  bool configure(const hal::OutputRates& rates_hz) override {
    constexpr float kMaxPwm_hz = 490.0f;
    constexpr float kMinDshot_hz = 150'000.0f;
    constexpr float kMaxDshot_hz = 1'200'000.0f;
    rates_ = rates_hz;
    bool ok = true;
    has_levels_ = false;
    for (float& rate : rates_) {
      const bool pwm = rate >= 0.0f && rate <= kMaxPwm_hz;
      if (pwm || (rate >= kMinDshot_hz && rate <= kMaxDshot_hz)) continue;
      ok = false;
      rate = kMaxPwm_hz;
    }
    for (std::size_t k = 0; k < rates_.size(); ++k) {
      if (rates_[k] != 0.0f) continue;
      has_levels_ = true;
      values_[k] = 0.0f;
    }
    enabled_ = true;
    return ok;
  }
  void write(const hal::OutputValues& values) override {
    ++writes_;
    if (!enabled_) return;
    using All = Eigen::Array<float, hal::kOutputs, 1>;
    Eigen::Map<All>(values_.data()) =
        All::Zero().max(Eigen::Map<const All>(values.data())).min(1.0f);  // so NaN becomes 0
    for (std::size_t k = 0; has_levels_ && k < rates_.size(); ++k) {
      if (rates_[k] == 0.0f) values_[k] = values_[k] >= kHighLevel ? 1.0f : 0.0f;
    }
  }
  void disable() override {
    enabled_ = false;
    values_.fill(0.0f);
  }

  const hal::OutputValues& values() const { return values_; }
  const hal::OutputRates& rates_hz() const { return rates_; }
  bool enabled() const { return enabled_; }
  std::uint64_t writes() const { return writes_; }

 private:
  hal::OutputValues values_{};
  hal::OutputRates rates_{};
  std::uint64_t writes_{0};
  bool enabled_{true};
  bool has_levels_{false};  ///< Since configure().
};

/// Lives as long as the process: that is the power of such a board.
class SimulatedBackup final : public hal::BackupMemory {
 public:
  bool read(std::uint8_t* data, std::size_t count) override {
    if (count > bytes_.size()) return false;
    std::copy_n(bytes_.begin(), count, data);
    return true;
  }
  bool write(const std::uint8_t* data, std::size_t count) override {
    if (count > bytes_.size()) return false;
    std::copy_n(data, count, bytes_.begin());
    return true;
  }
  void clear() override { bytes_.fill(0); }

 private:
  std::array<std::uint8_t, kSize> bytes_{};
};

class SimulatedLeds final : public hal::Leds {
 public:
  void set(hal::Led led, bool on) override { on_[static_cast<std::size_t>(led)] = on; }
  bool on(hal::Led led) const { return on_[static_cast<std::size_t>(led)]; }

 private:
  std::array<bool, 2> on_{};
};

/// A sensor besides the IMU still has a sample that the firmware has not taken: a real main loop
/// would turn once more before the next IMU sample.
template <class BoardOfMailboxes>
bool aids_waiting(const BoardOfMailboxes& board) {
  return board.mag.waiting() || board.baro.waiting() || board.diff_pressure.waiting() ||
         board.range.waiting() || board.gnss.waiting() || board.battery.waiting();
}

}  // namespace rosflight::boards
