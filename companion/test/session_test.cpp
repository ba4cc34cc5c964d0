// SPDX-License-Identifier: BSD-3-Clause
#include "companion/session.hpp"

#include <gtest/gtest.h>

#include "companion/test/rig.hpp"
#include "test_support/allocations.hpp"

namespace rosflight::companion::test {
namespace {

class Recorder final : public Listener {
 public:
  void on_imu(const link::Imu& m, const Stamp& s) override { imu.push_back({m, s}); }
  void on_attitude(const link::Attitude& m, const Stamp& s) override { attitude.push_back({m, s}); }
  void on_mag(const link::Mag& m, const Stamp& s) override { mag.push_back({m, s}); }
  void on_status(const link::Status& m, const Stamp& s) override { status.push_back({m, s}); }
  void on_received(const link::Message&, const Stamp&) override { ++received; }
  void on_sent(const link::Message&, Time) override { ++sent; }

  std::vector<std::pair<link::Imu, Stamp>> imu;
  std::vector<std::pair<link::Attitude, Stamp>> attitude;
  std::vector<std::pair<link::Mag, Stamp>> mag;
  std::vector<std::pair<link::Status, Stamp>> status;
  std::size_t received{0};
  std::size_t sent{0};
};

TEST(Session, KeepsTheRhythmOfTheProtocol) {
  Rig rig;
  rig.run_for(10s);
  EXPECT_NEAR(static_cast<double>(rig.fcu.count_received<link::Heartbeat>()), 10.0, 1.0);
  EXPECT_NEAR(static_cast<double>(rig.fcu.count_received<link::TimeSync>()), 100.0, 1.0);
  EXPECT_EQ(rig.fcu.count_received<link::ParamRequestList>(), 1U);
  EXPECT_EQ(rig.fcu.count_received<link::CommandRequest>(), 1U);  // the version
  EXPECT_EQ(rig.session.firmware_version(), "v2.0.1-12-gabcdef12");
  EXPECT_EQ(rig.session.version_match(), VersionMatch::kSame);
}

TEST(Session, SaysWhenTheFirmwareIsAnother) {
  Rig rig;
  rig.fcu.version = "v1.3.0";
  rig.run_for(100ms);
  const auto events = rig.log.of<VersionEvent>();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].match, VersionMatch::kDiffers);
}

// An armed ROSflight 2.x does not send its version; requests for it must stay rare.
TEST(Session, AsksForTheVersionLessOftenWhileRefused) {
  Rig rig;
  rig.fcu.armed = true;
  rig.run_for(60s);
  EXPECT_NEAR(static_cast<double>(rig.fcu.count_received<link::CommandRequest>()), 9.0, 2.0);
  rig.fcu.armed = false;
  EXPECT_TRUE(rig.run_until([&] { return !rig.session.firmware_version().empty(); }, 11s));
}

TEST(Session, ConnectionComesGoesAndComesBack) {
  Rig rig;
  rig.run_for(1s);
  EXPECT_TRUE(rig.session.connected());
  rig.fcu.silent = true;
  rig.run_for(1900ms);
  EXPECT_TRUE(rig.session.connected());
  rig.run_for(200ms);
  EXPECT_FALSE(rig.session.connected());
  rig.fcu.silent = false;
  EXPECT_TRUE(rig.run_until([&] { return rig.session.connected(); }, 1100ms));
  EXPECT_EQ(rig.log.count(ConnectionChange::kConnected), 2U);
  EXPECT_EQ(rig.log.count(ConnectionChange::kLost), 1U);
  EXPECT_EQ(rig.log.count(ConnectionChange::kRestarted), 0U);
}

// Changes that the FCU made without a link are detected afterwards.
TEST(Session, ReadsTheParametersAgainAfterASilence) {
  Rig rig;
  rig.run_for(1s);
  rig.link.plug(false);
  rig.run_for(100ms);
  EXPECT_FALSE(rig.session.connected());
  rig.fcu.find("P001")->value = ParameterValue::of(55.0f);
  rig.link.plug(true);
  ASSERT_TRUE(rig.run_until([&] { return rig.mirror("P001").as_float() == 55.0f; }, 3s));
  EXPECT_TRUE(rig.session.parameters().unsaved());
  EXPECT_EQ(rig.log.count(ConnectionChange::kLinkOpened), 2U);
  EXPECT_EQ(rig.log.count(ConnectionChange::kLinkClosed), 1U);
}

TEST(Session, NoticesARestartByTheClockAtOnce) {
  Rig rig;
  rig.run_for(5s);
  rig.fcu.restart();
  ASSERT_TRUE(
      rig.run_until([&] { return rig.log.count(ConnectionChange::kRestarted) == 1; }, 10ms));
  EXPECT_FALSE(rig.session.time_sync().synchronised());
  rig.run_for(1s);
  EXPECT_TRUE(rig.session.time_sync().synchronised());
  EXPECT_EQ(rig.session.statistics().restarts, 1U);
  EXPECT_TRUE(rig.session.parameters().complete());
  // FCU time zero is companion time of the boot.
  EXPECT_LE(std::chrono::abs(rig.session.time_sync().to_companion(rig.fcu.boot_clock()) - rig.now),
            Rig::kStep);
}

TEST(Session, StampsAreFcuTimeInCompanionTime) {
  Rig rig;
  Recorder recorder;
  rig.session.add(recorder);
  rig.run_for(1s);
  recorder.mag.clear();
  rig.fcu.send(link::Mag{});
  rig.session.step(rig.now + 1ms);

  const Stamp imu = recorder.imu.back().second;
  EXPECT_EQ(imu.source, StampSource::kFcuClock);
  EXPECT_EQ(imu.arrival, rig.now);
  // The fake's round trip is one step, all of it on the way up: half a step of error that nobody
  // can see.
  EXPECT_LE(std::chrono::abs(imu.sample - rig.now), Rig::kStep / 2 + 1us);
  // Milliseconds on the wire, microseconds restored: 2.5 ms steps would else be cut to 2 and 3 ms.
  const auto& a = recorder.attitude;
  EXPECT_EQ(a[a.size() - 1].second.sample - a[a.size() - 2].second.sample, Rig::kStep);
  // No time on the wire: that of the IMU sample of the same pass, not 1 ms later.
  ASSERT_EQ(recorder.mag.size(), 1U);
  EXPECT_EQ(recorder.mag[0].second.source, StampSource::kImuPass);
  EXPECT_EQ(recorder.mag[0].second.sample, std::min(imu.sample, rig.now + 1ms));
  EXPECT_EQ(recorder.mag[0].second.arrival, rig.now + 1ms);
}

TEST(Session, StampsOfWhatArrivesAfterAStallAreThoseOfTheSamples) {
  Rig rig;
  Recorder recorder;
  rig.session.add(recorder);
  rig.run_for(1s);
  recorder.mag.clear();
  std::vector<Time> sent;
  for (int k = 0; k < 200; ++k) {  // 0.5 s in which the computer reads nothing
    rig.now += Rig::kStep;
    rig.fcu.step(rig.now);
    if (k % 10 != 0) continue;
    rig.fcu.send(link::Mag{});
    sent.push_back(rig.now);
  }
  rig.session.step(rig.now);
  ASSERT_EQ(recorder.mag.size(), sent.size());
  for (std::size_t k = 0; k < sent.size(); ++k) {
    const Stamp& stamp = recorder.mag[k].second;
    EXPECT_EQ(stamp.source, StampSource::kImuPass) << k;
    EXPECT_LE(std::chrono::abs(stamp.sample - sent[k]), Rig::kStep) << k;
    EXPECT_EQ(stamp.arrival, rig.now) << k;
  }
}

TEST(Session, StampsFallBackToArrival) {
  Rig rig;
  rig.fcu.imu = false;
  Recorder recorder;
  rig.session.add(recorder);
  rig.run_for(1s);
  rig.fcu.send(link::Mag{});
  link::Imu wild;
  wild.time_boot_us = ~std::uint64_t{0};
  rig.fcu.send(wild);
  rig.fcu.send(link::Status{});
  rig.step();
  EXPECT_EQ(recorder.mag.at(0).second.source, StampSource::kArrival);
  EXPECT_EQ(recorder.imu.at(0).second.source, StampSource::kArrival);
  EXPECT_EQ(recorder.imu.at(0).second.sample, rig.now);
  EXPECT_EQ(recorder.status.at(0).second.source, StampSource::kArrival);
}

TEST(Session, KeepsLatestValuesCountsAndRates) {
  Rig rig;
  rig.run_for(3s);
  EXPECT_NEAR(rig.session.streams().imu.rate_hz, 400.0, 1.0);
  EXPECT_NEAR(rig.session.streams().heartbeat.rate_hz, 1.0, 0.01);
  EXPECT_EQ(rig.session.streams().imu.count, 1200U);
  EXPECT_EQ(rig.session.streams().gnss.count, 0U);
  // 44 + 40 bytes per pass, 17 of a heartbeat, 10 answers of 24 bytes.
  EXPECT_NEAR(rig.session.statistics().receive_rate_bytes_s, 400.0 * 84 + 17 + 240, 200.0);
  EXPECT_EQ(rig.session.statistics().frames.frames_dropped, 0U);
}

TEST(Session, AsksForReportsAndTellsTheirLines) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.connected(); }, 2s));
  ASSERT_TRUE(rig.session.request_report(link::ReportKind::kCounters));
  ASSERT_TRUE(rig.session.test_motor(2, 0.125F));
  rig.fcu.send(link::CheckResult{.index = 1, .count = 9, .result = 2});
  rig.fcu.send(link::Counters{.passes = 7});
  rig.run_for(100ms);
  ASSERT_EQ(rig.log.of<link::CheckResult>().size(), 1U);
  EXPECT_EQ(rig.log.of<link::CheckResult>()[0].index, 1);
  ASSERT_EQ(rig.log.of<link::Counters>().size(), 1U);
  EXPECT_EQ(rig.log.of<link::Counters>()[0].passes, 7U);
  EXPECT_EQ(rig.session.statistics().unexpected, 0U);
}

TEST(Session, PassesTextsErrorsAndEveryMessageOn) {
  Rig rig;
  Recorder recorder;
  rig.session.add(recorder);
  rig.step();
  rig.fcu.send_text("something to say", link::Severity::kWarning);
  rig.fcu.send(link::HardError{.error_code = 5, .pc = 0x08001234, .reset_count = 2, .rearm = 1});
  rig.step();
  ASSERT_EQ(rig.log.of<LogEvent>().size(), 1U);
  EXPECT_EQ(text_of(rig.log.of<LogEvent>()[0].line.text), "something to say");
  EXPECT_EQ(rig.log.of<LogEvent>()[0].line.severity, link::Severity::kWarning);
  ASSERT_EQ(rig.log.of<link::HardError>().size(), 1U);
  EXPECT_EQ(rig.log.of<link::HardError>()[0].pc, 0x08001234U);
  EXPECT_EQ(recorder.received, rig.session.statistics().frames.frames_received);
  EXPECT_EQ(recorder.sent, rig.codec.counters().frames_sent);
  rig.session.remove(recorder);
  const std::size_t before = recorder.received;
  rig.run_for(100ms);
  EXPECT_EQ(recorder.received, before);
}

// A cable that sends our own bytes back must not look like an FCU's answers.
TEST(Session, AnEchoIsCountedAndHarmless) {
  Rig rig;
  rig.run_for(1s);
  rig.fcu.send(link::ParamRequestList{});
  rig.fcu.send(link::OffboardControl{});
  rig.fcu.send(link::TimeSync{0, rig.now.count()});
  rig.step();
  EXPECT_EQ(rig.session.statistics().unexpected, 2U);
  EXPECT_TRUE(rig.session.connected());
}

TEST(Session, FollowsTheSystemIdItSet) {
  auto table = numbered_table(5);
  table.push_back({"SYS_ID", ParameterValue::of(1)});
  Rig rig(table);
  std::uint8_t id = 1;
  rig.fcu.intercept = [&](const link::Message& m) {
    if (const auto* set = std::get_if<link::ParamSet>(&m)) {
      if (set->target_system == id && text_of(set->name) == "SYS_ID") {
        id = static_cast<std::uint8_t>(set->value.bits);
      } else if (set->target_system != id) {
        return true;
      }
    }
    return false;
  };
  ASSERT_TRUE(rig.run_job(rig.session.parameters().set("SYS_ID", 9)));
  const auto job = rig.session.parameters().set("P001", 3.0);
  ASSERT_TRUE(rig.run_job(job, 1s));
  EXPECT_TRUE(job.done()) << job.text();
}

TEST(Session, RandomBytesNeverConnect) {
  Rig rig;
  rig.fcu.silent = true;
  Random random(99);
  for (int i = 0; i < 2000; ++i) {
    std::array<std::uint8_t, 64> noise{};
    for (auto& byte : noise) {
      byte = static_cast<std::uint8_t>(random.next());
    }
    rig.link.fcu_end().write(noise.data(), noise.size(), kOrdinary);
    rig.step();
  }
  EXPECT_FALSE(rig.session.connected());
  EXPECT_EQ(rig.session.statistics().bytes_received, 2000U * 64U);
}

TEST(Session, DoesNothingBetweenItsDueTimes) {
  Rig rig;
  rig.run_for(5s);
  rig.fcu.silent = true;
  rig.run_for(10 * Rig::kStep);
  const Time due = rig.session.next_due();
  ASSERT_GT(due, rig.now);
  EXPECT_LE(due, rig.now + 100ms);  // the next time synchronisation
  const auto sent = rig.codec.counters().frames_sent;
  rig.session.step(due - 1ns);
  EXPECT_EQ(rig.codec.counters().frames_sent, sent);
  rig.session.step(due);
  EXPECT_EQ(rig.codec.counters().frames_sent, sent + 1);
}

TEST(Session, TimeThatGoesBackIsHeld) {
  Rig rig;
  rig.run_for(1s);
  rig.session.step(1ms);
  EXPECT_EQ(rig.session.now(), rig.now);
}

TEST(Session, SteadyStateDoesNotAllocate) {
  // Bare: the rig's fake and its lossy cable use the heap.
  InProcessLink cable(1 << 16);
  link::MavlinkCodec ours{{1, link::MavlinkCodec::kCompanionComponent}};
  link::MavlinkCodec theirs{{1, link::MavlinkCodec::kFcuComponent}};
  Session session(ours, cable.companion_end(), {});
  const auto put = [&](const link::Message& message) {
    link::Frame frame;
    theirs.encode(message, frame);
    cable.fcu_end().write(frame.bytes.data(), frame.size, kOrdinary);
  };
  const auto run = [&](Time from, Time to) {
    std::array<std::uint8_t, 4096> sink{};
    for (Time t = from; t < to; t += Rig::kStep) {
      link::Imu imu;
      imu.time_boot_us = static_cast<std::uint64_t>(t.count() / 1000);
      put(imu);
      put(link::Attitude{});
      put(link::Heartbeat{});
      put(link::Status{});
      put(link::StatusText{});
      put(link::TimeSync{t.count(), t.count()});
      session.step(t);
      static_cast<void>(session.offboard().send(angles(0, 0, 0, 0.5f)));
      cable.fcu_end().read(sink.data(), sink.size());
    }
  };
  run(1s, 3s);
  ASSERT_TRUE(session.connected());
  const std::size_t before = test_support::allocations();
  run(3s, 20s);
  EXPECT_EQ(test_support::allocations() - before, 0U);
}

}  // namespace
}  // namespace rosflight::companion::test
