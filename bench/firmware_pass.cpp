// SPDX-License-Identifier: BSD-3-Clause
// Runs the firmware armed in hover for a number of passes, for counting instructions: an IMU sample
// in every pass at 400 Hz, a receiver frame at 50 Hz, angle mode, all streams on.
//
// usage: firmware_pass --passes N [--link-protocol mavlink|lean|none]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

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
    const std::size_t count = std::min(capacity, waiting_);
    std::memcpy(data, incoming_.bytes.data(), count);
    waiting_ = 0;
    return count;
  }
  void put(const link::Frame& frame) {
    incoming_ = frame;
    waiting_ = frame.size;
  }

 private:
  link::Frame incoming_{};
  std::size_t waiting_{0};
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

class Rig {
 public:
  explicit Rig(link::Codec& codec) : firmware_{board_.roles(wire_), codec} {
    firmware_.start();
    set("PRIMARY_MIXER", 2);
    set("FAILSAFE_THR", 0.3F);
    set("RC_ARM_CHN", 5);
  }

  void pass(float throttle, bool arm) {
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
    firmware_.run();
  }

  bool bring_up() {
    firmware_.handle(
        link::CommandRequest{static_cast<std::uint8_t>(link::Command::kAccelCalibration)},
        board_.clock.now());
    for (int k = 0; k < 2000; ++k) {
      if (k % 400 == 0) firmware_.handle(link::Heartbeat{}, board_.clock.now());
      pass(0.0F, false);
    }
    for (int k = 0; k < 100; ++k) pass(0.0F, true);
    return firmware_.state().armed();
  }

 private:
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
  core::Firmware firmware_;
  std::int64_t passes_{0};
};

}  // namespace

int main(int argc, char** argv) {
  long passes = -1;
  const char* protocol = "mavlink";
  for (int k = 1; k + 1 < argc; k += 2) {
    if (std::strcmp(argv[k], "--link-protocol") == 0) protocol = argv[k + 1];
    if (std::strcmp(argv[k], "--passes") == 0) passes = std::strtol(argv[k + 1], nullptr, 10);
  }
  link::MavlinkCodec mavlink{{1, link::MavlinkCodec::kFcuComponent}};
  link::LeanCodec lean;
  NoCodec none;
  link::Codec* codec = nullptr;
  if (std::strcmp(protocol, "mavlink") == 0) codec = &mavlink;
  if (std::strcmp(protocol, "lean") == 0) codec = &lean;
  if (std::strcmp(protocol, "none") == 0) codec = &none;
  if (passes < 0 || codec == nullptr) {
    std::fprintf(stderr, "usage: firmware_pass --passes N [--link-protocol mavlink|lean|none]\n");
    return 2;
  }
  const auto rig = std::make_unique<Rig>(*codec);
  if (!rig->bring_up()) {
    std::fprintf(stderr, "firmware_pass: the firmware did not arm\n");
    return 1;
  }
  for (long k = 0; k < passes; ++k) rig->pass(0.5F, true);
  return 0;
}
