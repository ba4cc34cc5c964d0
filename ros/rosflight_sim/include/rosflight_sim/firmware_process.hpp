// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>

#include "firmware/boards/common/simulated_peripherals.hpp"
#include "firmware/boards/linux/file_storage.hpp"
#include "firmware/boards/linux/linux_serial.hpp"
#include "firmware/boards/linux/linux_system.hpp"
#include "firmware/core/firmware.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight_sim {

namespace base = rosflight::base;
namespace link = rosflight::link;
namespace hal = rosflight::hal;
namespace core = rosflight::core;
namespace boards = rosflight::boards;

/// The time of a node, counted from the last boot. Never set back: when the node's time jumps back
/// or stands, this stands.
class NodeClock final : public hal::Clock {
 public:
  using Now = std::function<hal::Time()>;

  explicit NodeClock(Now node_time) : node_time_{std::move(node_time)} { boot(); }

  hal::Time now() const override {
    const hal::Time t = node_time_();
    if (t < last_) offset_ += last_ - t;  // set back: go on from where it was
    last_ = t;
    return t + offset_ - boot_;
  }
  void boot() {
    last_ = node_time_();
    offset_ = hal::Time{0};
    boot_ = last_;
  }

 private:
  Now node_time_;
  hal::Time boot_{};
  mutable hal::Time last_{};
  mutable hal::Time offset_{};
};

/// The firmware with its board inside a node: link over UDP, memory in a file, time of the node.
/// Not thread-safe: one caller at a time.
class FirmwareProcess {
 public:
  /// @throws boards::LinuxError  one line: port taken, unknown host, memory file in use.
  FirmwareProcess(const base::LinkAddress& link, const std::filesystem::path& memory,
                  NodeClock::Now node_time)
      : clock_{std::move(node_time)}, system_{clock_}, serial_{link}, storage_{memory} {
    boot();
  }

  /// Sensor samples and receiver frames: the newest waits for the next pass. Their stamps are
  /// replaced by the board's time `age` ago. That of an IMU sample is never before the last one: the board's time may have stood
  /// still while the sample was on its way.
  template <class Sample>
  void put(Sample sample, hal::Time age) {
    sample.stamp = std::max(clock_.now() - age, hal::Time{0});
    if constexpr (std::is_same_v<Sample, hal::ImuSample>)
      last_imu_ = sample.stamp = std::max(sample.stamp, last_imu_);
    mailbox(sample).put(sample);
  }

  /// One pass of the main loop. A reset that it asks for is done before this returns: a new
  /// firmware object reads its parameters from the memory file.
  void pass() {
    serial_.receive();
    autopilot_->firmware.run();
    serial_.transmit();
    if (!system_.reset_requested()) return;
    ++restarts_;
    boot();
  }

  const hal::OutputValues& outputs() const { return outputs_.values(); }
  const core::Firmware& firmware() const { return autopilot_->firmware; }
  boards::LinuxSerial& serial() { return serial_; }
  std::uint64_t restarts() const { return restarts_; }
  /// The memory file was not there before: the firmware runs on its defaults.
  bool blank_memory() const { return storage_.created(); }

 private:
  struct Autopilot {
    explicit Autopilot(const hal::Board& board) : firmware{board, codec} {}
    link::MavlinkCodec codec{{1, link::MavlinkCodec::kFcuComponent}};
    core::Firmware firmware;
  };

  boards::Mailbox<hal::ImuSample>& mailbox(const hal::ImuSample&) { return imu_; }
  boards::Mailbox<hal::MagSample>& mailbox(const hal::MagSample&) { return mag_; }
  boards::Mailbox<hal::BaroSample>& mailbox(const hal::BaroSample&) { return baro_; }
  boards::Mailbox<hal::DiffPressureSample>& mailbox(const hal::DiffPressureSample&) {
    return diff_pressure_;
  }
  boards::Mailbox<hal::RangeSample>& mailbox(const hal::RangeSample&) { return range_; }
  boards::Mailbox<hal::GnssSample>& mailbox(const hal::GnssSample&) { return gnss_; }
  boards::SimulatedBattery& mailbox(const hal::BatterySample&) { return battery_; }
  boards::SimulatedReceiver& mailbox(const hal::RcFrame&) { return receiver_; }

  void boot() {
    outputs_.disable();
    serial_.clear();
    system_.restarted();
    clock_.boot();
    last_imu_ = hal::Time{0};
    autopilot_.reset();
    autopilot_ = std::make_unique<Autopilot>(
        hal::Board{clock_, system_, serial_, storage_, backup_, leds_, outputs_, receiver_,
                   battery_, imu_, mag_, baro_, diff_pressure_, range_, gnss_});
    autopilot_->firmware.start();
  }

  NodeClock clock_;
  hal::Time last_imu_{};
  boards::LinuxSystem system_;
  boards::LinuxSerial serial_;
  boards::FileStorage storage_;
  boards::SimulatedBackup backup_;
  boards::SimulatedLeds leds_;
  boards::SimulatedOutputs outputs_;
  boards::SimulatedReceiver receiver_;
  boards::SimulatedBattery battery_;
  boards::Mailbox<hal::ImuSample> imu_;
  boards::Mailbox<hal::MagSample> mag_;
  boards::Mailbox<hal::BaroSample> baro_;
  boards::Mailbox<hal::DiffPressureSample> diff_pressure_;
  boards::Mailbox<hal::RangeSample> range_;
  boards::Mailbox<hal::GnssSample> gnss_;
  std::unique_ptr<Autopilot> autopilot_;  ///< Autopilot since the last boot.
  std::uint64_t restarts_{0};
};

}  // namespace rosflight_sim
