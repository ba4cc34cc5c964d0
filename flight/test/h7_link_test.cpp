// SPDX-License-Identifier: BSD-3-Clause
// The link of the boards with an STM32H7 over the UART at the rates of BAUD_RATE, on the emulated chip: bytes take their time, and a far
// end with another rate cannot read them.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "base/constants.hpp"
#include "companion/session.hpp"
#include "flight/test/h7_rig.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr std::array<std::uint32_t, 8> kRates{57'600,  115'200,   230'400,   460'800,
                                              921'600, 1'500'000, 2'000'000, 3'000'000};
constexpr double kAnswer_s = 3.0, kLongestList_s = 20.0;

/// A board at rest and level, with all of its streams, and a companion at the other end of its UART.
class Bench {
 public:
  explicit Bench(const std::string& board) : autopilot_{cable_, emulated_chip(board)} {
    autopilot_.start(now_);
  }

  companion::Session& session() { return session_; }
  std::uint64_t lost() const { return autopilot_.figures()->uart_lost; }
  std::uint32_t resets() const { return autopilot_.figures()->resets; }

  void run_for(double duration_s) {
    for (const sim::Time end = now_ + at_s(duration_s); now_ < end;) step();
  }
  /// Steps until that holds, for `limit_s` at most. @returns whether it does.
  template <class Condition>
  bool wait_for(double limit_s, Condition condition) {
    for (const sim::Time end = now_ + at_s(limit_s); !condition() && now_ < end;) step();
    return condition();
  }
  /// The power goes and comes back; the companion's end has this rate from then on.
  void restart(std::uint32_t far_baud) {
    autopilot_.set_link_baud(far_baud);
    autopilot_.break_down(now_, Autopilot::Breakdown::kPowerLoss);
    run_for(2.5);  // start-up, and the companion's timeout of 2 s
  }

  /// Asks for all parameters. @returns how many came.
  std::size_t list() {
    auto job = session_.parameters().refresh();
    EXPECT_TRUE(wait_for(kLongestList_s, [&job] { return !job.pending(); }));
    EXPECT_FALSE(job.failed()) << job.text();
    return session_.parameters().table().fresh();
  }

  void set(const std::string& name, double value) {
    auto job = session_.parameters().set(name, value);
    EXPECT_TRUE(wait_for(kAnswer_s, [&job] { return !job.pending(); })) << name;
    EXPECT_FALSE(job.failed()) << job.text();
  }
  double read(const std::string& name) {
    auto job = session_.parameters().read(name);
    EXPECT_TRUE(wait_for(kAnswer_s, [&job] { return !job.pending(); })) << name;
    EXPECT_FALSE(job.failed()) << job.text();
    return session_.parameters().get(name)->number();
  }
  /// Stores BAUD_RATE, which is in force from the next start on.
  void store_baud(std::uint32_t baud) {
    set("BAUD_RATE", baud);
    auto stored = session_.commands().start(link::Command::kWriteParams);
    EXPECT_TRUE(wait_for(kAnswer_s, [&stored] { return !stored.pending(); }));
    EXPECT_FALSE(stored.failed()) << stored.text();
  }

 private:
  void step() {
    now_ += kChipStep;
    sim::SensorSamples samples;
    samples.has_imu = samples.has_mag = samples.has_baro = samples.has_diff_pressure = true;
    samples.imu.stamp = now_;
    samples.imu.accel_m_s2 = {0.0F, 0.0F, -static_cast<float>(base::kStandardGravity_m_s2)};
    samples.imu.temperature_K = 300.0F;
    samples.mag.field_T = {2e-5F, 0.0F, 4e-5F};
    samples.baro.pressure_Pa = 101'325.0F;
    samples.baro.temperature_K = 300.0F;
    samples.diff_pressure.temperature_K = 300.0F;
    autopilot_.step(now_, samples, nullptr);
    if (now_ % Flight::kStep == sim::Time{0}) session_.step(now_);
  }

  sim::Time now_{};
  CableLink cable_{sim::RandomSource{1}};
  ChipAutopilot autopilot_;
  link::MavlinkCodec codec_{{1, link::MavlinkCodec::kCompanionComponent}};
  companion::Session session_{codec_, autopilot_.link(), {}};
};

class EachImage : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, EachImage, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(EachImage, WritesAndReadsParametersAtEachUsualRate) {
  Bench bench{GetParam()};
  ASSERT_TRUE(bench.wait_for(kAnswer_s, [&bench] { return bench.session().connected(); }));
  double value = 0.5;
  for (const std::uint32_t baud : kRates) {
    SCOPED_TRACE(baud);
    bench.store_baud(baud);
    bench.restart(baud);
    const std::uint64_t lost_before = bench.lost();
    EXPECT_EQ(bench.list(), bench.session().parameters().table().count());
    EXPECT_EQ(bench.read("BAUD_RATE"), baud);
    value += 0.03125;
    bench.set("FILT_ACC_KP", value);
    EXPECT_EQ(bench.read("FILT_ACC_KP"), value);
    EXPECT_EQ(bench.lost(), lost_before);
  }
  EXPECT_EQ(bench.resets(), 0U);
}

TEST_P(EachImage, IsNotReadByAFarEndOfAnotherRate) {
  Bench bench{GetParam()};
  ASSERT_TRUE(bench.wait_for(3.0, [&bench] { return bench.session().connected(); }));
  bench.store_baud(460'800);
  bench.restart(921'600);
  const std::uint64_t received = bench.session().statistics().bytes_received;
  const std::uint64_t lost = bench.lost();
  bench.run_for(1.0);
  EXPECT_FALSE(bench.session().connected());
  EXPECT_EQ(bench.session().statistics().bytes_received, received);
  EXPECT_GT(bench.lost(), lost + 1000U);
}

}  // namespace
}  // namespace rosflight::flight::testing
