// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/linux_autopilot.hpp"
#include "link/mavlink/mavlink_codec.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <thread>

#include "firmware/boards/linux/test/far_end.hpp"

namespace rosflight::flight {
namespace {

using boards::Bytes;
using boards::LinuxBoard;
using boards::LinuxClock;
using link::MavlinkCodec;

/// A ground tool at the far end of a TCP link.
class Ground {
 public:
  explicit Ground(LinuxBoard& board)
      : board_{board},
        socket_{boards::connect_tcp(boards::port_in(boards::word(board.serial.where(), "link")))} {}

  void send(const link::Message& message) {
    link::Frame frame;
    codec_.encode(message, frame);
    EXPECT_EQ(::write(socket_.get(), frame.bytes.data(), frame.size),
              static_cast<ssize_t>(frame.size));
    const std::uint64_t goal = board_.serial.counters().bytes_received + frame.size;
    while (board_.serial.counters().bytes_received < goal) {
      std::vector<pollfd> set;
      board_.serial.add_to(set);
      ASSERT_GT(::poll(set.data(), set.size(), boards::kTimeout_ms), 0);
      board_.serial.receive();
    }
  }
  /// The next message of a type among all that come within the timeout.
  template <class Message>
  Message expect() {
    for (int wait = 0; wait < 100; ++wait) {
      while (used_ < bytes_.size()) {
        const auto result = codec_.decode(bytes_.data() + used_, bytes_.size() - used_);
        used_ += result.consumed;
        if (!result.complete) continue;
        if (const auto* found = std::get_if<Message>(&codec_.message())) return *found;
      }
      bytes_.assign(65536, 0);
      used_ = 0;
      pollfd set{socket_.get(), POLLIN, 0};
      const bool any = ::poll(&set, 1, 100) > 0;
      const ssize_t n = any ? ::read(socket_.get(), bytes_.data(), bytes_.size()) : 0;
      bytes_.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    }
    ADD_FAILURE() << "no such message";
    return {};
  }

 private:
  LinuxBoard& board_;
  base::FileDescriptor socket_;
  MavlinkCodec codec_{{1, MavlinkCodec::kCompanionComponent}};
  Bytes bytes_;
  std::size_t used_{0};
};

class LinuxAutopilotTest : public ::testing::Test {
 protected:
  static link::ParamSet set(const char* parameter, std::int32_t value) {
    link::ParamSet message;
    message.target_system = 1;
    message.name = core::padded_name(parameter);
    message.type = static_cast<std::uint8_t>(link::ParamType::kInt32);
    message.value = {static_cast<std::uint32_t>(value)};
    return message;
  }

  boards::TemporaryFolder folder_;
  LinuxBoard board_{base::parse_board_link("tcp:0"), folder_ / "memory"};
  LinuxAutopilot sil_{board_};
  Ground ground_{board_};
};

TEST_F(LinuxAutopilotTest, AnswersBytesWithoutWaitingForASample) {
  ground_.send(link::TimeSync{0, 123'456});
  const std::uint64_t passes = board_.system.passes();
  const hal::Time before = board_.clock.now();
  sil_.link_pass();
  const hal::Time after = board_.clock.now();
  EXPECT_EQ(board_.system.passes(), passes + 1);
  const auto answer = ground_.expect<link::TimeSync>();
  EXPECT_EQ(answer.ts1_ns, 123'456);
  EXPECT_GE(answer.tc1_ns, before.count() * 1000);
  EXPECT_LE(answer.tc1_ns, after.count() * 1000);
}

TEST_F(LinuxAutopilotTest, StampsSamplesWithTheTickAndTheDistancesOfSimulatedTime) {
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const hal::Time tick = LinuxClock::steady();
  sil_.set_tick(tick);
  sim::SensorSamples samples;
  samples.has_imu = samples.has_baro = true;
  samples.imu.stamp = hal::milliseconds(1000);
  samples.imu.accel_m_s2 = {0.0f, 0.0f, -9.80665f};
  samples.baro.stamp = hal::milliseconds(997);
  samples.baro.pressure_Pa = 101325.0f;
  samples.baro.temperature_K = 288.15f;
  static_cast<void>(sil_.step(hal::milliseconds(1000), samples, nullptr));
  const auto& measured = sil_.firmware().sensors().measurements();
  EXPECT_EQ(measured.imu.stamp, board_.clock.at(tick));
  EXPECT_EQ(measured.baro.stamp, board_.clock.at(tick) - hal::milliseconds(3));
}

TEST_F(LinuxAutopilotTest, WhatWasMeasuredBeforeTheStartIsOfTimeZero) {
  sil_.set_tick(LinuxClock::steady());
  sim::SensorSamples samples;
  samples.has_baro = true;
  samples.baro.stamp = hal::Time{0};
  samples.baro.pressure_Pa = 101325.0f;
  samples.baro.temperature_K = 288.15f;
  static_cast<void>(sil_.step(hal::milliseconds(3'600'000), samples, nullptr));
  EXPECT_EQ(sil_.firmware().sensors().measurements().baro.pressure_Pa, 101325.0f);
  EXPECT_EQ(sil_.firmware().sensors().measurements().baro.stamp, hal::Time{0});
}

TEST_F(LinuxAutopilotTest, ARebootBuildsTheFirmwareAnewFromWhatWasWritten) {
  ground_.send(set("NUM_MOTORS", 6));
  sil_.link_pass();
  ground_.send(link::CommandRequest{static_cast<std::uint8_t>(link::Command::kWriteParams)});
  for (int k = 0; k < 300; ++k) sil_.link_pass();  // a block is written in each
  ASSERT_TRUE(ground_.expect<link::CommandAck>().success);
  ground_.send(set("NUM_MOTORS", 8));
  sil_.link_pass();
  ASSERT_EQ(sil_.firmware().parameters().get_int(core::Param::kNumMotors), 8);

  ground_.send(link::CommandRequest{static_cast<std::uint8_t>(link::Command::kReboot)});
  sil_.link_pass();
  ASSERT_TRUE(ground_.expect<link::CommandAck>().success);
  for (int ms = 0; ms < boards::kTimeout_ms && sil_.restarts() == 0; ++ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    sil_.link_pass();
  }
  ASSERT_EQ(sil_.restarts(), 1u);
  EXPECT_FALSE(board_.system.reset_requested());
  EXPECT_EQ(sil_.firmware().parameters().get_int(core::Param::kNumMotors), 6);
}

}  // namespace
}  // namespace rosflight::flight
