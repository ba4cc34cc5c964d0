// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/firmware.hpp"
#include "firmware/core/test/random_flight.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::core {

/// What one pass did, as far as the board and the link see it.
struct PassWork {
  int messages_decoded{0};
  std::size_t bytes_read{0};
  std::size_t bytes_encoded{0};
  int storage_writes{0};
  int storage_reads{0};
  int storage_while_armed{0};
  int settings_derived{0};
  int outputs_written{0};
  int watchdog_fed{0};
  bool output_out_of_range{false};
  bool received_companion{false};
  bool received_offboard{false};
  bool received_auxiliary{false};
  bool received_motor_test{false};  ///< For this system.
  bool received_parameters{false};  ///< A message that can change the table.
};

class WatchedStorage final : public hal::Storage {
 public:
  WatchedStorage(boards::SimulatedClock& clock, PassWork& work) : clock_{clock}, work_{work} {}
  std::size_t size() const override { return bytes_.size(); }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override {
    ++work_.storage_reads;
    note();
    if (fault == StorageFault::kFailedReads || fault == StorageFault::kFailed) return false;
    if (offset > bytes_.size() || count > bytes_.size() - offset) return false;
    std::memcpy(data, &bytes_[offset], count);
    return true;
  }
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override {
    ++work_.storage_writes;
    note();
    if (fault == StorageFault::kSlow) clock_.set(clock_.now() + hal::milliseconds(8));
    if (fault == StorageFault::kFailedWrites || fault == StorageFault::kFailed) return false;
    if (offset > bytes_.size() || count > bytes_.size() - offset) return false;
    std::memcpy(&bytes_[offset], data, count);
    return true;
  }
  bool flush() override {
    return fault != StorageFault::kFailedWrites && fault != StorageFault::kFailed;
  }

  StorageFault fault{StorageFault::kNone};
  const Firmware* user{nullptr};

 private:
  void note() {
    if (user != nullptr && user->state().armed()) ++work_.storage_while_armed;
  }

  std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(std::size_t{16384}, 0xFF);
  boards::SimulatedClock& clock_;
  PassWork& work_;
};

class WatchedOutputs final : public hal::Outputs {
 public:
  explicit WatchedOutputs(PassWork& work) : work_{work} {}
  bool configure(const hal::OutputRates& /*rates_hz*/) override {
    enabled_ = true;
    return true;
  }
  void write(const hal::OutputValues& values) override {
    ++work_.outputs_written;
    for (const float v : values) {
      if (!(v >= 0.0f && v <= 1.0f)) work_.output_out_of_range = true;
    }
    if (!enabled_) return;
    values_ = values;
    for (std::size_t k = 0; k < values.size(); ++k) peak_[k] = std::max(peak_[k], values[k]);
  }
  void disable() override {
    enabled_ = false;
    values_.fill(0.0f);
  }
  const hal::OutputValues& values() const { return values_; }
  /// The largest that was written to each since begin_pass().
  const hal::OutputValues& peak() const { return peak_; }
  void begin_pass() { peak_.fill(0.0f); }

 private:
  PassWork& work_;
  hal::OutputValues values_{};
  hal::OutputValues peak_{};
  bool enabled_{false};
};

class WatchedBattery final : public boards::Mailbox<hal::BatterySample, hal::Battery> {
 public:
  explicit WatchedBattery(PassWork& work) : work_{work} {}
  /// Called whenever the firmware derives the settings of its modules.
  void set_multipliers(float /*voltage*/, float /*current*/) override { ++work_.settings_derived; }

 private:
  PassWork& work_;
};

class WatchedSystem final : public hal::System {
 public:
  explicit WatchedSystem(PassWork& work) : work_{work} {}
  void start_sensors() override {}
  std::uint16_t sensor_errors() const override { return 0; }
  const char* sensor_message(std::size_t /*index*/, bool& /*ok*/) const override { return nullptr; }
  void reset(bool /*to_bootloader*/) override { reset_requested = true; }
  void feed_watchdog() override { ++work_.watchdog_fed; }
  Time busy_time() const override { return Time{0}; }
  bool shares_processor() const override { return false; }

  bool reset_requested{false};

 private:
  PassWork& work_;
};

/// Takes everything that is sent; holds what shall be read.
class WatchedWire final : public hal::Serial {
 public:
  explicit WatchedWire(PassWork& work) : work_{work} {}
  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
  bool write(const std::uint8_t* /*data*/, std::size_t size, std::uint8_t /*qos*/) override {
    work_.bytes_encoded += size;
    return true;
  }
  std::size_t writable() const override { return 4096; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    const std::size_t count = std::min(capacity, incoming_.size() - taken_);
    if (count > 0) std::memcpy(data, &incoming_[taken_], count);
    taken_ += count;
    work_.bytes_read += count;
    if (taken_ == incoming_.size()) clear();
    return count;
  }
  void put(const std::uint8_t* data, std::size_t size) {
    incoming_.insert(incoming_.end(), data, data + size);
  }
  void clear() {
    incoming_.clear();
    taken_ = 0;
  }
  bool waiting() const { return taken_ < incoming_.size(); }

 private:
  PassWork& work_;
  std::vector<std::uint8_t> incoming_;
  std::size_t taken_{0};
};

/// Counts what a MAVLink codec decodes, and remembers the texts it encodes.
class WatchedCodec final : public link::Codec {
 public:
  explicit WatchedCodec(PassWork& work) : work_{work} {}
  bool encode(const link::Message& message, link::Frame& frame) override {
    if (const auto* text = std::get_if<link::StatusText>(&message)) last_text = *text;
    return codec_.encode(message, frame);
  }
  Decoded decode(const std::uint8_t* data, std::size_t size) override {
    const Decoded result = codec_.decode(data, size);
    if (result.complete) note(codec_.message());
    return result;
  }
  const link::Message& message() const override { return codec_.message(); }
  void set_system_id(std::uint8_t id) override { codec_.set_system_id(id); }
  const Counters& counters() const override { return codec_.counters(); }

  std::optional<link::StatusText> last_text;

 private:
  void note(const link::Message& message) {
    ++work_.messages_decoded;
    work_.received_companion = true;
    if (std::holds_alternative<link::OffboardControl>(message)) work_.received_offboard = true;
    if (std::holds_alternative<link::AuxCommand>(message)) work_.received_auxiliary = true;
    if (const auto* test = std::get_if<link::MotorTest>(&message)) {
      work_.received_motor_test = work_.received_motor_test || test->target_system <= 1;
    }
    if (std::holds_alternative<link::ParamSet>(message) ||
        std::holds_alternative<link::CommandRequest>(message)) {
      work_.received_parameters = true;
    }
  }

  link::MavlinkCodec codec_{{1, link::MavlinkCodec::kFcuComponent}};
  PassWork& work_;
};

/// A firmware on a board that counts, and the companion at its other end. It survives restarts as a
/// board does: storage and backup memory stay, all else begins again.
class WatchedFirmware {
 public:
  /// @param companion  identity of the sender of all messages.
  WatchedFirmware(const RandomFlight& flight, link::MavlinkCodec::Identity companion)
      : companion_{companion} {
    Parameters parameters;
    flight.configure(parameters);
    ParameterStore nvm(storage_);
    if (nvm.save(parameters) != StoreResult::kOk) throw std::runtime_error("storage is too small");
    start();
  }

  /// One pass, with a restart before it if there shall be one.
  /// @param foreign  whether messages for another system arrive too.
  void pass(const PassInputs& in, bool foreign) {
    storage_.fault = in.storage;
    restarted_ = false;
    now_ = in.now + delay_;
    clock_.set(now_ - boot_);
    if (in.restart != Restart::kNone || system_.reset_requested) restart(in.restart);
    if (in.imu) imu_.put(shifted(*in.imu));
    if (in.mag) mag_.put(shifted(*in.mag));
    if (in.baro) baro_.put(shifted(*in.baro));
    if (in.diff_pressure) diff_pressure_.put(shifted(*in.diff_pressure));
    if (in.range) range_.put(shifted(*in.range));
    if (in.gnss) gnss_.put(shifted(*in.gnss));
    if (in.battery) battery_.put(shifted(*in.battery));
    if (in.rc) receiver_.put(shifted(*in.rc));
    for (const Packet& packet : in.packets) {
      if (packet.garbage_size > 0) {
        wire_.put(packet.garbage.data(), packet.garbage_size);
      } else if (foreign || !packet.foreign) {
        link::Frame frame;
        if (companion_.encode(packet.message, frame)) wire_.put(frame.bytes.data(), frame.size);
      }
    }
    work_ = PassWork{};
    outputs_.begin_pass();
    now_ = clock_.now() + boot_;
    firmware_->run();
    delay_ += clock_.now() + boot_ - now_;  // what a slow storage took
  }

  const Firmware& firmware() const { return *firmware_; }
  const PassWork& work() const { return work_; }
  const hal::OutputValues& outputs() const { return outputs_.values(); }
  const hal::OutputValues& peak_outputs() const { return outputs_.peak(); }
  const WatchedCodec& codec() const { return *codec_; }
  /// When the last pass began; unlike the board's clock it goes on over restarts.
  Time now() const { return now_; }
  /// The last pass was the first after a restart.
  bool restarted() const { return restarted_; }
  bool messages_wait() const { return wire_.waiting(); }

 private:
  template <class Sample>
  Sample shifted(Sample sample) const {
    sample.stamp += delay_ - boot_;
    return sample;
  }
  void start() {
    codec_.emplace(work_);
    storage_.user = nullptr;
    firmware_.reset();
    firmware_ = std::make_unique<Firmware>(
        hal::Board{clock_, system_, wire_, storage_, backup_, leds_, outputs_, receiver_, battery_,
                   imu_, mag_, baro_, diff_pressure_, range_, gnss_},
        *codec_);
    storage_.user = firmware_.get();
    firmware_->start();
    delay_ += clock_.now();
    restarted_ = true;
  }
  void restart(Restart kind) {
    constexpr std::array<std::uint32_t, 8> kRegisters{0, 0, 0, 0, 0, 0, 0x0800'1234, 0};
    if (kind == Restart::kFault) firmware_->record_fault(kRegisters);
    if (kind == Restart::kPowerCut) backup_.clear();
    system_.reset_requested = false;
    wire_.clear();
    outputs_.disable();
    boot_ = now_;
    clock_.set(Time{0});
    start();
  }

  PassWork work_;
  boards::SimulatedClock clock_;
  WatchedSystem system_{work_};
  WatchedWire wire_{work_};
  WatchedStorage storage_{clock_, work_};
  boards::SimulatedBackup backup_;
  boards::SimulatedLeds leds_;
  WatchedOutputs outputs_{work_};
  boards::SimulatedReceiver receiver_;
  WatchedBattery battery_{work_};
  boards::Mailbox<hal::ImuSample> imu_;
  boards::Mailbox<hal::MagSample> mag_;
  boards::Mailbox<hal::BaroSample> baro_;
  boards::Mailbox<hal::DiffPressureSample> diff_pressure_;
  boards::Mailbox<hal::RangeSample> range_;
  boards::Mailbox<hal::GnssSample> gnss_;
  link::MavlinkCodec companion_;
  std::optional<WatchedCodec> codec_;
  std::unique_ptr<Firmware> firmware_;
  Time delay_{};
  Time now_{};
  Time boot_{};
  bool restarted_{false};
};

}  // namespace rosflight::core
