// SPDX-License-Identifier: BSD-3-Clause
// Every hundredth byte of the serial cable is damaged: which commands the firmware accepts, and who is in
// control while they are missing.
#include <gtest/gtest.h>

#include <cmath>

#include <vector>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "flight/autopilot/hosted_firmware.hpp"
#include "flight/link_protocol.hpp"
#include "link/mavlink/mavlink_codec.hpp"
#include "sim/serial_cable.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr sim::Time kStep{2500};
constexpr sim::Time kTimeout = hal::milliseconds(100);  // OFFBOARD_TIMEOUT
constexpr double kNoise = 0.01;

/// The firmware's serial port on a cable, with a second reader of the same bytes, which knows nothing of the firmware.
class WatchedPort final : public hal::Serial {
 public:
  WatchedPort(sim::SerialCable& cable, const sim::Time& now) : cable_{cable}, now_{now} {}
  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
    return cable_.to_companion.push(now_, data, size, qos);
  }
  std::size_t writable() const override { return cable_.to_companion.writable(); }
  std::size_t read(std::uint8_t* data, std::size_t capacity) override {
    const std::size_t size = cable_.to_board.pop(now_, data, capacity);
    for (std::size_t used = 0; used < size;) {
      const auto result = codec_.decode(data + used, size - used);
      used += result.consumed;
      const auto* command = std::get_if<link::OffboardControl>(&codec_.message());
      if (!result.complete || command == nullptr) continue;
      received.push_back(command->u[9]);
      last_received = now_;
    }
    return size;
  }
  std::uint32_t bad_frames() const { return codec_.counters().frames_dropped; }

  std::vector<float> received;  ///< u[9] of the commands that came through.
  sim::Time last_received{-1'000'000};

 private:
  sim::SerialCable& cable_;
  const sim::Time& now_;
  link::MavlinkCodec codec_{{1, link::MavlinkCodec::kFcuComponent}};
};

struct NoisyLink : ::testing::TestWithParam<int> {
  NoisyLink() { firmware.boot(board.roles(serial), make_board_codec("mavlink")); }

  void send(float number) {
    link::OffboardControl command;
    command.mode = 2;
    command.u[9] = number;
    link::Frame frame;
    ASSERT_TRUE(companion.encode(command, frame));
    intact_share = std::pow(1.0 - kNoise, static_cast<double>(frame.size));
    ASSERT_TRUE(cable.to_board.push(now, frame.bytes.data(), frame.size, 255));
  }
  void step() {
    now += kStep;
    board.clock.set(now);
    if (cable.to_board.waiting(now) > 0) (*firmware).run();
    hal::ImuSample imu;
    imu.stamp = now;
    imu.accel_m_s2 = {0.0F, 0.0F, -9.80665F};
    board.imu.put(imu);
    (*firmware).run();
  }

  double intact_share{};  ///< Expected share of intact frames.
  sim::Time now{};
  sim::SerialLine::Config config = [] {
    sim::SerialLine::Config c;
    c.corruption_per_byte = kNoise;
    return c;
  }();
  sim::SerialCable cable{config, sim::RandomSource{1}};
  WatchedPort serial{cable, now};
  boards::SimulatedBoard board;
  HostedFirmware firmware;
  link::MavlinkCodec companion{{1, link::MavlinkCodec::kCompanionComponent}};
};

TEST_P(NoisyLink, EveryGapHandsOverAndEveryFrameTakesOverAgain) {
  const int steps_between_commands = GetParam();
  constexpr int kSteps = 80'000;  // 200 s
  std::size_t gaps = 0;
  std::size_t recoveries = 0;
  double sent = 0.0;
  bool was_active = false;
  for (int k = 0; k < kSteps; ++k) {
    if (k % steps_between_commands == 0) send(static_cast<float>(++sent));
    step();
    const bool active = (*firmware).command().offboard_active();
    ASSERT_EQ(active, now - serial.last_received <= kTimeout) << "step " << k;
    gaps += static_cast<std::size_t>(was_active && !active);
    recoveries += static_cast<std::size_t>(!was_active && active);
    was_active = active;
  }
  EXPECT_GT(gaps, 10U);
  EXPECT_LE(gaps, recoveries);
  EXPECT_LE(recoveries, gaps + 1);

  const double deviation = std::sqrt(intact_share * (1.0 - intact_share) / sent);
  EXPECT_NEAR(static_cast<double>(serial.received.size()) / sent, intact_share, 4.0 * deviation);
  EXPECT_GT(serial.bad_frames(), 100U);
  float last = 0.0F;
  for (const float number : serial.received) {
    ASSERT_GT(number, last) << "never sent, or twice";
    ASSERT_EQ(number, std::floor(number));
    last = number;
  }
  EXPECT_LE(last, sent);
}
INSTANTIATE_TEST_SUITE_P(At, NoisyLink, ::testing::Values(8, 20, 30), [](const auto& param) {
  return "Every" + std::to_string(param.param * kStep.count() / 1000) + "ms";
});

}  // namespace
}  // namespace rosflight::flight::testing
