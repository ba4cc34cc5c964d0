// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/telemetry.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <vector>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::core {
namespace {

using hal::milliseconds;

/// Notes the priority of every frame.
class NotingSerial final : public hal::Serial {
 public:
  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return true; }
  bool write(const std::uint8_t* data, std::size_t size, std::uint8_t qos) override {
    frames.emplace_back(data, data + size);
    priorities.push_back(qos);
    return true;
  }
  std::size_t writable() const override { return room; }
  std::size_t read(std::uint8_t* /*data*/, std::size_t /*capacity*/) override { return 0; }

  std::vector<std::vector<std::uint8_t>> frames;
  std::vector<std::uint8_t> priorities;
  std::size_t room{4096};
};

class TelemetryTest : public testing::Test {
 protected:
  std::vector<link::Message> sent() {
    std::vector<link::Message> messages;
    for (const auto& frame : serial_.frames) {
      if (companion_.decode(frame.data(), frame.size()).complete) {
        messages.push_back(companion_.message());
      }
    }
    serial_.frames.clear();
    return messages;
  }
  template <class M>
  std::size_t count() {
    std::size_t n = 0;
    for (const auto& m : sent()) n += std::holds_alternative<M>(m) ? 1u : 0u;
    return n;
  }

  void backlog(Time now = milliseconds(5)) {
    telemetry_.send_backlog(now, {outputs_, frame_}, parameters_, log_);
  }

  NotingSerial serial_;
  hal::OutputValues outputs_{};
  hal::RcFrame frame_;
  link::MavlinkCodec fcu_{{1, 250}};
  link::MavlinkCodec companion_{{1, 50}};
  Telemetry telemetry_{serial_, fcu_};
  Parameters parameters_;
  Log log_;
};

TEST_F(TelemetryTest, ImuGoesFirstAndEverythingElseOrdinary) {
  Measurements m;
  m.new_imu = m.new_aid = m.new_baro = m.new_gnss = true;
  parameters_.mark_all_reported();
  telemetry_.stream(m, {});
  telemetry_.stream({}, {});
  backlog();
  ASSERT_EQ(serial_.priorities.size(), 5u);  // IMU, attitude, barometer, GNSS, outputs
  EXPECT_EQ(serial_.priorities[0], 0);
  for (std::size_t k = 1; k < 5; ++k) EXPECT_EQ(serial_.priorities[k], 255);
}

template <std::size_t... kAlternatives>
std::vector<link::Message> one_of_each(std::index_sequence<kAlternatives...>) {
  return {link::Message(std::in_place_index<kAlternatives + 1>)...};
}

TEST_F(TelemetryTest, EveryMessageHasTheSameUrgencyOnEveryBoard) {
  constexpr auto kAll = std::variant_size_v<link::Message> - 1;
  for (const link::Message& message : one_of_each(std::make_index_sequence<kAll>{})) {
    serial_.priorities.clear();
    telemetry_.send(message);
    ASSERT_EQ(serial_.priorities.size(), 1u);
    const std::size_t wanted = std::holds_alternative<link::Imu>(message)        ? 0
                               : std::holds_alternative<link::TimeSync>(message) ? 1
                                                                                 : 2;
    EXPECT_EQ(hal::Serial::class_of(serial_.priorities[0]), wanted) << message.index();
  }
  for (unsigned qos = 0; qos < 256; ++qos) {
    EXPECT_EQ(hal::Serial::class_of(static_cast<std::uint8_t>(qos)), qos == 0     ? 0u
                                                                     : qos == 255 ? 2u
                                                                                  : 1u);
  }
}

TEST_F(TelemetryTest, NothingNewSendsNothing) {
  parameters_.mark_all_reported();
  telemetry_.stream({}, {});
  backlog();
  EXPECT_TRUE(serial_.frames.empty());
}

TEST_F(TelemetryTest, HeartbeatBeginsEverySecondAndSurvivesGaps) {
  std::size_t status = 0;
  for (int ms = 0; ms < 3000; ++ms) status += telemetry_.tick(milliseconds(ms), false) ? 1u : 0u;
  EXPECT_EQ(status, 30u);
  EXPECT_EQ(count<link::Heartbeat>(), 3u);
  telemetry_.tick(milliseconds(7777), false);
  EXPECT_EQ(count<link::Heartbeat>(), 1u) << "a gap of seconds: one";
  for (int ms = 7778; ms < 8000; ++ms) telemetry_.tick(milliseconds(ms), false);
  EXPECT_EQ(count<link::Heartbeat>(), 0u);
  telemetry_.tick(milliseconds(8000), false);
  EXPECT_EQ(count<link::Heartbeat>(), 1u);
}

TEST_F(TelemetryTest, ARequestedStatusIsDueOnce) {
  telemetry_.tick(milliseconds(0), false);
  EXPECT_FALSE(telemetry_.tick(milliseconds(1), false));
  telemetry_.request_status();
  telemetry_.request_status();
  EXPECT_TRUE(telemetry_.tick(milliseconds(2), false));
  EXPECT_FALSE(telemetry_.tick(milliseconds(3), false));
}

TEST_F(TelemetryTest, ACrashReportWaitsForThePeerAndIsSentOnce) {
  CrashRecord record;
  record.fault_count = 3;
  record.error_word = 0x21;
  record.registers[6] = 0x0800BEEF;
  telemetry_.report_crash(record, true);
  EXPECT_EQ(count<link::HardError>(), 0u);
  telemetry_.note_peer_frame(milliseconds(100));
  const auto messages = sent();
  ASSERT_EQ(messages.size(), 1u);
  const auto& report = std::get<link::HardError>(messages[0]);
  EXPECT_EQ(report.error_code, 0x21u);
  EXPECT_EQ(report.pc, 0x0800BEEFu);
  EXPECT_EQ(report.reset_count, 3u);
  EXPECT_EQ(report.rearm, 1u);
  telemetry_.note_peer_frame(milliseconds(200));
  EXPECT_EQ(count<link::HardError>(), 0u);
}

TEST_F(TelemetryTest, TheBacklogLeavesRoomForTheStreams) {
  parameters_.mark_all_reported();
  log_.info("hello");
  telemetry_.note_peer_frame(milliseconds(0));
  telemetry_.start_list();
  serial_.room = 256;
  telemetry_.stream({}, {});
  backlog();
  EXPECT_TRUE(serial_.frames.empty());
  serial_.room = 257;
  telemetry_.stream({}, {});
  backlog();
  EXPECT_EQ(serial_.frames.size(), 3u) << "two parameters and one text";
}

TEST_F(TelemetryTest, ChangedParametersGoBeforeTheRestOfAList) {
  parameters_.mark_all_reported();
  telemetry_.start_list();
  telemetry_.stream({}, {});
  backlog();
  sent();
  ASSERT_EQ(parameters_.set_float(Param::kRcMaxThr, 0.5f), SetResult::kChanged);
  telemetry_.stream({}, {});
  backlog();
  const auto messages = sent();
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(std::get<link::ParamValue>(messages[0]).index,
            static_cast<std::uint16_t>(Param::kRcMaxThr));
  EXPECT_EQ(std::get<link::ParamValue>(messages[1]).index, 2);
}

TEST_F(TelemetryTest, APassWithAnImuSampleSendsOneMessageBesidesIt) {
  parameters_.mark_all_reported();
  telemetry_.note_peer_frame(milliseconds(0));
  Measurements m;
  m.new_imu = true;
  const auto pass = [&](bool aid) {
    m.new_aid = m.new_baro = aid;
    telemetry_.stream(m, {});
    telemetry_.note_rc();
    backlog();
    return sent();
  };
  telemetry_.start_list();
  for (int k = 0; k < 12; ++k) log_.info("text");
  std::map<std::size_t, int> seen;
  for (int k = 0; k < 32; ++k) {
    const auto messages = pass(false);
    ASSERT_EQ(messages.size(), 3u) << "IMU, attitude and one more";
    ++seen[messages[2].index()];
  }
  EXPECT_EQ(seen[link::Message(link::OutputRaw{}).index()], 4) << "every eighth IMU sample";
  EXPECT_GT(seen[link::Message(link::RcChannels{}).index()], 8);
  EXPECT_GT(seen[link::Message(link::ParamValue{}).index()], 8);
  EXPECT_GE(seen[link::Message(link::StatusText{}).index()], 8);

  int others = 0;
  for (int k = 0; k < 64; ++k) {
    const auto messages = pass(true);
    ASSERT_LE(messages.size(), 4u);
    EXPECT_TRUE(std::holds_alternative<link::Baro>(messages[2]));
    others += messages.size() == 4 ? 1 : 0;
  }
  EXPECT_EQ(others, 8) << "passed over for eight passes at most, however busy the sensors are";
}

TEST_F(TelemetryTest, PulsesOfAnyChannelValueAreNumbersInRange) {
  parameters_.mark_all_reported();
  hal::RcFrame& frame = frame_;
  frame.channel_count = 24;
  frame.channels[0] = std::numeric_limits<float>::quiet_NaN();
  frame.channels[1] = -5.0f;
  frame.channels[2] = 1e9f;
  frame.channels[17] = 0.5f;
  telemetry_.stream({}, {});
  telemetry_.note_rc();
  backlog(milliseconds(7));
  const auto messages = sent();
  ASSERT_EQ(messages.size(), 1u);
  const auto& rc = std::get<link::RcChannels>(messages[0]);
  EXPECT_EQ(rc.pulse_us[0], 0);
  EXPECT_EQ(rc.pulse_us[1], 0);
  EXPECT_EQ(rc.pulse_us[2], 65535);
  EXPECT_EQ(rc.pulse_us[17], 1500);
  EXPECT_EQ(rc.count, 18) << "as many as the message holds";
  EXPECT_EQ(rc.time_boot_ms, 7u);
}

TEST_F(TelemetryTest, MillisecondFieldsWrapAtTheirWidthOnly) {
  // 2^32 ms are 49.7 days; the field has 32 bits, the clock 64.
  Measurements m;
  m.new_imu = true;
  m.imu.stamp = milliseconds((std::int64_t{1} << 32) + 5);
  parameters_.mark_all_reported();
  telemetry_.stream(m, {});
  backlog(m.imu.stamp);
  const auto messages = sent();
  EXPECT_EQ(std::get<link::Imu>(messages[0]).time_boot_us, ((1ull << 32) + 5) * 1000);
  EXPECT_EQ(std::get<link::Attitude>(messages[1]).time_boot_ms, 5u);
  EXPECT_EQ(std::get<link::OutputRaw>(messages[2]).time_boot_ms, (1ull << 32) + 5);
}

}  // namespace
}  // namespace rosflight::core
