// SPDX-License-Identifier: BSD-3-Clause
// The flight record of the boards with an STM32H7, on the emulated chip: a crash in flight, read back over the link.
#include <gtest/gtest.h>

#include <iterator>
#include <map>
#include <vector>

#include "companion/record_reader.hpp"
#include "firmware/boards/parts/flight_record.hpp"
#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using boards::parts::FlightRecord;
using companion::RecordReader;
using Entry = FlightRecord::Entry;
using Kind = FlightRecord::Kind;
using Breakdown = Autopilot::Breakdown;

constexpr double kCrash_s = 20.0;
constexpr int kTwoSamples_us = 2500;  // at 1 kHz, and half of one

/// What the flight's own log has of the time before the crash.
class Received final : public companion::Listener {
 public:
  explicit Received(companion::Session& session) : session_{session} { session_.add(*this); }
  ~Received() override { session_.remove(*this); }

  void on_imu(const link::Imu& m, const companion::Stamp&) override {
    if (listening) imu[static_cast<std::int64_t>(m.time_boot_us)] = m;
  }
  void on_attitude(const link::Attitude& m, const companion::Stamp&) override {
    if (listening) attitude[m.time_boot_ms] = m;
  }
  void on_received(const link::Message& m, const companion::Stamp&) override {
    if (std::holds_alternative<link::RecordPart>(m)) ++entries;
  }

  std::map<std::int64_t, link::Imu> imu;
  std::map<std::uint32_t, link::Attitude> attitude;
  int entries{0};
  bool listening{true};

 private:
  companion::Session& session_;
};

/// Reads the record over the link. @returns what is intact, in its order.
std::vector<Entry> read_record(Rig& rig) {
  RecordReader reader(rig.flight->session());
  const sim::Time end = rig.flight->now() + at_s(60.0);
  while (reader.state() == RecordReader::State::kReading && rig.flight->now() < end) {
    rig.flight->step();
    reader.step();
  }
  EXPECT_EQ(reader.state(), RecordReader::State::kComplete);
  std::vector<Entry> record;
  for (const auto& [number, bytes] : reader.entries()) {
    Entry entry;
    if (FlightRecord::decode(bytes.data(), entry)) record.push_back(entry);
  }
  EXPECT_GE(record.size() + 1, reader.entries().size()) << "one may have been cut";
  return record;
}

/// The entries from the start with this index up to the next start.
std::vector<Entry> run_of(const std::vector<Entry>& record, int index) {
  std::vector<Entry> run;
  int starts = 0;
  for (const Entry& entry : record) {
    if (entry.kind == Kind::kStart) ++starts;
    if (starts == index + 1) run.push_back(entry);
  }
  return run;
}

std::vector<boards::parts::FlightMoment> moments_of(const std::vector<Entry>& run) {
  std::vector<boards::parts::FlightMoment> moments;
  for (const Entry& entry : run) {
    if (entry.kind == Kind::kMoment) moments.push_back(entry.moment);
  }
  return moments;
}

std::string texts_of(const std::vector<Entry>& run) {
  std::string texts;
  for (const Entry& entry : run) {
    if (entry.kind == Kind::kText) texts += std::string(entry.text.data()) + "\n";
  }
  return texts;
}

class FlightRecordOf : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, FlightRecordOf, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(FlightRecordOf, HasACrashInFlightAsTheLogOfTheFlightHasIt) {
  FlightChoice choice = on_board({}, GetParam());
  choice.link = "usb";
  Rig rig{choice};
  Received received(rig.flight->session());
  rig.run_until(15.0);
  rig.flight->session().request_record(0, 10);
  rig.run_until(kCrash_s);
  EXPECT_EQ(received.entries, 0) << "in flight the link has other work";
  ASSERT_TRUE(view_of(rig).armed);
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kCrash);
  received.listening = false;
  rig.flight->run();
  ASSERT_TRUE(rig.completed()) << rig.flight->runner().failure();
  ASSERT_EQ(chip_of(rig).figures()->resets, 1U);

  const std::vector<Entry> record = read_record(rig);
  const auto before = moments_of(run_of(record, 0));
  ASSERT_GT(before.size(), 1000U) << "the flight up to the crash, 100 times per second";
  ASSERT_FALSE(received.imu.empty());
  EXPECT_NEAR(static_cast<double>(before.back().time.count()),
              static_cast<double>(received.imu.rbegin()->first), 20'000.0)
      << "up to the crash";
  std::size_t compared = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const auto& moment = before[k];
    EXPECT_EQ(moment.flags & 1U, 1U) << "armed";
    if (k > 0) {
      const auto step_us = static_cast<double>((moment.time - before[k - 1].time).count());
      EXPECT_NEAR(step_us, 10'000.0, 3000.0) << k;
    }
    const auto imu = received.imu.lower_bound(moment.time.count());
    if (imu == received.imu.end()) {
      EXPECT_GE(k + 3, before.size()) << "only the last ones were on their way when it crashed";
      continue;
    }
    if (imu->first != moment.time.count()) {  // the link carries every second sample of 1 kHz
      ASSERT_NE(imu, received.imu.begin());
      EXPECT_LE(imu->first - std::prev(imu)->first, kTwoSamples_us) << "thinned out, not lost";
      continue;
    }
    ++compared;
    EXPECT_EQ(moment.accel_m_s2, imu->second.accel_m_s2);
    EXPECT_EQ(moment.gyro_rad_s, imu->second.gyro_rad_s);
    const auto attitude =
        received.attitude.find(static_cast<std::uint32_t>(moment.time.count() / 1000));
    if (attitude == received.attitude.end()) continue;
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(moment.q_WB[i], attitude->second.q_WB[i], 1e-6) << k;
  }
  EXPECT_GT(compared, before.size() / 3);
  EXPECT_GT(before.back().outputs[0], 0.1F) << "in the air";

  const auto after = run_of(record, 1);
  ASSERT_FALSE(after.empty());
  const std::string texts = texts_of(after);
  EXPECT_NE(texts.find("Rearmed after a fault in flight"), std::string::npos) << texts;
  EXPECT_NE(texts.find("Fault 1 at pc "), std::string::npos) << texts;
  const auto flown_on = moments_of(after);
  ASSERT_GT(flown_on.size(), 900U);
  EXPECT_LE(flown_on.back().time, hal::milliseconds(10'200)) << "then it is held";
}

/// Two temperatures of the chip: 16 bits and its factory values resolve 0.03 K.
TEST_P(FlightRecordOf, HasTheTemperatureOfTheProcessorAndAWarningIsSentOnce) {
  FlightChoice choice = on_board({}, GetParam());
  choice.mission = "hop";
  Rig rig{choice};
  std::string notes;
  rig.flight->runner().set_notify([&notes](const FlightNote& note) { notes += note.text + "\n"; });
  double& chip_degC = chip_of(rig).process().to_chip().chip_degC;
  chip_degC = 57.5;
  rig.run_until(12.0);
  ASSERT_TRUE(view_of(rig).armed);
  EXPECT_EQ(notes.find("degC"), std::string::npos) << "for the record only: " << notes;
  chip_degC = 108.5;
  rig.flight->run();
  ASSERT_TRUE(rig.completed()) << rig.flight->runner().failure();
  rig.run_for(12.0);
  const std::size_t warning = notes.find("Chip above 105 degC: 108\n");
  ASSERT_NE(warning, std::string::npos) << notes;
  EXPECT_EQ(notes.find("Chip", warning + 1), std::string::npos) << notes;
  const std::string texts = texts_of(read_record(rig));
  EXPECT_NE(texts.find("Chip degC: 57\n"), std::string::npos) << texts;
  EXPECT_NE(texts.find("Chip above 105 degC: 108\n"), std::string::npos) << texts;
}

TEST(FlightRecordOfPixracerPro, IsEmptyAfterAPowerCycle) {
  Rig rig{on_board()};
  rig.run_until(8.0);
  ASSERT_TRUE(view_of(rig).armed);
  rig.flight->runner().set_notify(nullptr);
  rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kPowerLoss);
  rig.run_for(1.5);
  EXPECT_TRUE(moments_of(read_record(rig)).empty());
}

}  // namespace
}  // namespace rosflight::flight::testing
