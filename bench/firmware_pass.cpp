// SPDX-License-Identifier: BSD-3-Clause
// Runs the firmware armed in hover for a number of passes, for counting instructions: an IMU sample
// in every pass at 400 Hz, a receiver frame at 50 Hz, angle mode, all streams on.
//
//     hover   nothing else
//     full    all sensors at the rates of the simulated ones, offboard commands at 400 Hz,
//             heartbeat and time synchronization
//     storm   the same, and the passes are counted one by one while everything comes at once:
//             every sensor, and more messages than a pass takes, of the dearest kinds
//
// usage: firmware_pass --passes N [--link-protocol mavlink|lean|none] [--load hover|full|storm]
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/firmware.hpp"
#include "link/lean/lean_codec.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file

/// A wire that takes everything and brings nothing.
class OpenWire final : public hal::Serial {
 public:
  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t /*qos*/) override {
    last_ = data[size - 1];
    return true;
  }
  std::size_t writable() const override { return 4096; }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    const std::size_t count = std::min(capacity, waiting_ - taken_);
    std::memcpy(data, incoming_.data() + taken_, count);
    taken_ += count;
    if (taken_ == waiting_) taken_ = waiting_ = 0;
    return count;
  }
  /// Drops what does not fit, as a full buffer of a serial port does.
  void put(const link::Frame& frame) {
    if (waiting_ + frame.size > incoming_.size()) return;
    std::memcpy(incoming_.data() + waiting_, frame.bytes.data(), frame.size);
    waiting_ += frame.size;
  }

 private:
  std::array<std::uint8_t, 4096> incoming_{};
  std::size_t waiting_{0};
  std::size_t taken_{0};
  volatile std::uint8_t last_{0};
};

/// A link that does nothing.
class NoCodec final : public link::Codec {
 public:
  bool encode(const link::Message& /*message*/, link::Frame& frame) override {
    frame.size = 0;
    return false;
  }
  Decoded decode(const std::uint8_t* /*data*/, std::size_t size) override { return {size, false}; }
  const link::Message& message() const override { return message_; }
  void set_system_id(std::uint8_t /*id*/) override {}
  const Counters& counters() const override { return counters_; }

 private:
  link::Message message_;
  Counters counters_;
};

enum class Load { kHover, kFull, kStorm };

/// One pass, by a name that callgrind accepts: it counts from here to the return.
extern "C" __attribute__((noinline)) void bench_counted_pass(core::Firmware& firmware) {
  firmware.run();
  asm volatile("");
}

class Rig {
 public:
  Rig(link::Codec& codec, link::Codec& companion)
      : companion_{companion}, firmware_{board_.roles(wire_), codec} {
    firmware_.start();
    set("PRIMARY_MIXER", 2);
    set("FAILSAFE_THR", 0.3F);
    set("RC_ARM_CHN", 5);
  }

  void pass(float throttle, bool arm, Load load = Load::kHover) {
    constexpr int kStep_us = 2500;
    constexpr int kPassesPerFrame = 8;
    const hal::Time now = hal::microseconds(++passes_ * kStep_us);
    board_.clock.set(now);
    const float wobble = 0.01F * static_cast<float>(passes_ % 7 - 3);
    board_.imu.put(
        {now, {0.05F + wobble, -0.03F, -9.7F + wobble}, {0.02F + wobble, -wobble, 0.01F}, 300.0F});
    if (passes_ % kPassesPerFrame == 0) {
      hal::RcFrame frame;
      frame.stamp = now;
      frame.channel_count = 8;
      frame.channels = {0.52F, 0.49F, throttle, 0.5F, 0.0F, arm ? 1.0F : 0.0F, 0.0F, 0.0F};
      board_.receiver.put(frame);
    }
    if (load != Load::kHover) put_full_load(now);
    if (load == Load::kStorm) {
      put_storm(now);
      bench_counted_pass(firmware_);
    } else {
      firmware_.run();
    }
  }

  /// Encodes what the companion sends beforehand, so that its work is not counted.
  void prepare() {
    link::OffboardControl command;
    command.mode = static_cast<std::uint8_t>(link::OffboardMode::kRollPitchYawrateThrottle);
    command.u = {0.0F, 0.0F, 0.5F, 0.02F, -0.02F, 0.1F, 0.0F, 0.0F, 0.0F, 0.0F};
    for (auto& frame : offboard_) companion_.encode(command, frame);
    companion_.encode(link::Heartbeat{}, beat_);
    companion_.encode(link::TimeSync{0, 1}, sync_);
  }

  bool bring_up() {
    firmware_.handle(
        link::CommandRequest{static_cast<std::uint8_t>(link::Command::kAccelCalibration)},
        board_.clock.now());
    for (int k = 0; k < 2000; ++k) {
      if (k % 400 == 0) firmware_.handle(link::Heartbeat{}, board_.clock.now());
      pass(0.0F, false);
    }
    // Changed parameters are stored first, a block in each pass.
    for (int k = 0; k < 1000 && !firmware_.state().armed(); ++k) pass(0.0F, true);
    for (int k = 0; k < 400; ++k) pass(0.0F, true);  // motors at idle first
    return firmware_.state().armed();
  }

 private:
  /// Sensors at the rates of the simulated ones; none shares all its passes with another.
  void put_full_load(hal::Time now) {
    const auto due = [this](int every, int phase) { return passes_ % every == phase; };
    if (due(4, 0)) board_.mag.put({now, {2e-5F, 1e-6F, 4e-5F}, 300.0F});
    if (due(8, 1)) board_.baro.put({now, 95'000.0F, 300.0F});
    if (due(4, 2)) board_.diff_pressure.put({now, 2.0F, 300.0F});
    if (due(20, 3)) board_.range.put({now, 2.0F, 0.1F, 10.0F, hal::RangeKind::kLidar});
    if (due(40, 5)) put_gnss(now);
    if (due(40, 7)) board_.battery.put({now, 24.0F, 10.0F});
    wire_.put(offboard_[static_cast<std::size_t>(passes_) % offboard_.size()]);
    if (due(400, 9)) wire_.put(beat_);
    if (due(40, 11)) wire_.put(sync_);
  }
  void put_gnss(hal::Time now) {
    hal::GnssSample gnss;
    gnss.stamp = now;
    gnss.fix = hal::GnssFix::k3d;
    board_.gnss.put(gnss);
  }
  /// Everything at once. Each pass is another of the storms, so that the dearest is among them.
  void put_storm(hal::Time now) {
    board_.mag.put({now, {2e-5F, 1e-6F, 4e-5F}, 300.0F});
    board_.baro.put({now, 95'000.0F, 300.0F});
    board_.diff_pressure.put({now, 2.0F, 300.0F});
    board_.range.put({now, 2.0F, 0.1F, 10.0F, hal::RangeKind::kLidar});
    board_.battery.put({now, 24.0F, 10.0F});
    put_gnss(now);
    hal::RcFrame frame;
    frame.stamp = now;
    frame.channel_count = 8;
    frame.channels = {0.52F, 0.49F, 0.5F, 0.5F, 0.0F, 1.0F, 0.0F, 0.0F};
    board_.receiver.put(frame);
    constexpr int kMessages = 24;
    constexpr int kKinds = 6;
    for (int k = 0; k < kMessages; ++k) send(storm_message(static_cast<int>(passes_) % kKinds, k));
  }
  link::Message storm_message(int kind, int k) {
    link::ParamSet change;
    change.type = static_cast<std::uint8_t>(link::ParamType::kFloat);
    change.name = core::padded_name(k % 2 == 0 ? "PID_ROLL_RATE_P" : "PID_YAW_RATE_P");
    const float gain = 0.1F + 0.001F * static_cast<float>((passes_ + k) % 16);
    std::memcpy(&change.value.bits, &gain, sizeof gain);
    link::OffboardControl refused;
    refused.mode = 200;
    switch (kind) {
      case 0:
        return change;
      case 1:
        return link::ParamRequestRead{1, static_cast<std::int16_t>(k), {}};
      case 2:  // a name that does not exist: the whole table is searched, and a text is made
        return link::ParamRequestRead{1, -1, core::padded_name("RC_ARM_THRESHOLE")};
      case 3:
        return k % 2 == 0 ? link::Message{link::ParamRequestList{1}} : link::Message{change};
      case 4:
        return link::CommandRequest{static_cast<std::uint8_t>(link::Command::kSendVersion)};
      default:
        return k % 2 == 0 ? link::Message{refused} : link::Message{link::TimeSync{0, k}};
    }
  }
  void send(const link::Message& message) {
    link::Frame frame;
    if (companion_.encode(message, frame)) wire_.put(frame);
  }
  template <class Value>
  void set(const char* name, Value value) {
    link::ParamSet message;
    message.name = core::padded_name(name);
    message.type = static_cast<std::uint8_t>(std::is_integral_v<Value> ? link::ParamType::kInt32
                                                                       : link::ParamType::kFloat);
    std::memcpy(&message.value.bits, &value, sizeof value);
    firmware_.handle(message, {});
  }

  OpenWire wire_;
  boards::SimulatedBoard board_;
  link::Codec& companion_;
  std::array<link::Frame, 256> offboard_;  // one for each sequence number
  link::Frame beat_, sync_;
  core::Firmware firmware_;
  std::int64_t passes_{0};
};

}  // namespace

int main(int argc, char** argv) {
  long passes = -1;
  const char* protocol = "mavlink";
  Load load = Load::kHover;
  bool known = argc % 2 == 1;
  for (int k = 1; k + 1 < argc; k += 2) {
    if (std::strcmp(argv[k], "--link-protocol") == 0) protocol = argv[k + 1];
    if (std::strcmp(argv[k], "--passes") == 0) passes = std::strtol(argv[k + 1], nullptr, 10);
    if (std::strcmp(argv[k], "--load") != 0) continue;
    const std::string_view wanted = argv[k + 1];
    known = known && (wanted == "hover" || wanted == "full" || wanted == "storm");
    load = wanted == "storm" ? Load::kStorm : wanted == "full" ? Load::kFull : Load::kHover;
  }
  link::MavlinkCodec mavlink{{1, link::MavlinkCodec::kFcuComponent}};
  link::MavlinkCodec mavlink_companion{{1, link::MavlinkCodec::kCompanionComponent}};
  link::LeanCodec lean, lean_companion;
  NoCodec none;
  link::Codec* codec = nullptr;
  link::Codec* companion = &none;
  if (std::strcmp(protocol, "mavlink") == 0) codec = &mavlink, companion = &mavlink_companion;
  if (std::strcmp(protocol, "lean") == 0) codec = &lean, companion = &lean_companion;
  if (std::strcmp(protocol, "none") == 0) codec = &none;
  if (!known || passes < 0 || codec == nullptr) {
    std::fprintf(stderr,
                 "usage: firmware_pass --passes N [--link-protocol mavlink|lean|none] "
                 "[--load hover|full|storm]\n");
    return 2;
  }
  const auto rig = std::make_unique<Rig>(*codec, *companion);
  rig->prepare();
  if (!rig->bring_up()) {
    std::fprintf(stderr, "firmware_pass: the firmware did not arm\n");
    return 1;
  }
  for (long k = 0; k < passes; ++k) rig->pass(0.5F, true, load);
  return 0;
}
