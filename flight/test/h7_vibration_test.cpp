// SPDX-License-Identifier: BSD-3-Clause
// Vibration lines from the rotors to the controller on an emulated board: the part's filter, the core's filters at
// the gyro's own rate, and what folds where samples are left out. Truth is integrated at that rate. And whether the
// stamps of samples are the times of the motion that they show.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "base/constants.hpp"
#include "flight/gyro_spectrum.hpp"
#include "flight/test/h7_rig.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr double kLine = 5e-4;  // of the gyro, per rotor speed: 12 deg/s in hover
constexpr double kControl_Hz = 1000.0, kGyro_Hz = 2000.0, kPart_Hz = 230.0;

/// Samples of the IMU as the companion receives them.
class ImuTap final : public LinkTap {
 public:
  struct Sample {
    double t_s;  ///< Time on the board's clock.
    Spectrum::Rates rates_rad_s;
  };
  void on_frame(Direction direction, hal::Time /*t*/, const std::uint8_t* data, std::size_t size,
                bool /*taken*/) override {
    if (direction != Direction::kToCompanion || !listening) return;
    if (!codec_.decode(data, size).complete) return;
    if (const auto* const imu = std::get_if<link::Imu>(&codec_.message()))
      samples.push_back({1e-6 * static_cast<double>(imu->time_boot_us), imu->gyro_rad_s});
  }
  bool listening{false};
  std::vector<Sample> samples;

 private:
  link::MavlinkCodec codec_{{1, link::MavlinkCodec::kCompanionComponent}};
};

struct Hover {
  std::vector<ImuTap::Sample> samples;
  double rotor_Hz{};  ///< Mean of the rotors.
  double sigma{};     ///< Size of a line, on one axis.
  double delay_s{};   ///< By which the stamped rates are behind the true ones.
};

/// What differs least from the true rates, moved in time: (g - w)' w_dot over w_dot' w_dot.
double delay_of(const std::vector<ImuTap::Sample>& samples, double boot_s,
                const std::vector<sim::Truth>& truths) {
  double product = 0.0, power = 0.0;
  for (const ImuTap::Sample& sample : samples) {
    const double t_s = sample.t_s + boot_s;
    const double begin_s = sim::to_seconds(truths.front().time);
    const double step_s = sim::to_seconds(Flight::kStep);
    const double place = (t_s - begin_s) / step_s;
    if (place < 0.0 || place + 1.0 >= static_cast<double>(truths.size() - 1)) continue;
    const auto k = static_cast<std::size_t>(place);
    const double share = place - std::floor(place);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double from = truths[k].body.w_B[axis], to = truths[k + 1].body.w_B[axis];
      const double slope = (to - from) / step_s;
      const double true_rate = from + share * (to - from);
      const auto seen = static_cast<double>(sample.rates_rad_s[static_cast<std::size_t>(axis)]);
      product += (seen - true_rate) * slope;
      power += slope * slope;
    }
  }
  return -product / power;
}

/// Four seconds of the default mission.
Hover fly(int blades, std::vector<std::string> overrides,
          const std::string& board = "pixracer_pro") {
  FlightChoice choice = on_board({}, board);
  choice.link = "usb";
  choice.overrides = std::move(overrides);
  choice.overrides.push_back("sensors.imu.blades=" + std::to_string(blades));
  ImuTap tap;
  Rig rig{choice};
  rig.flight->set_tap(&tap);
  rig.run_until(10.0);
  tap.listening = true;
  Hover hover;
  std::vector<sim::Truth> truths;
  double speeds_rad_s = 0.0, squares = 0.0;
  while (rig.flight->now() < at_s(14.0)) {
    rig.flight->step();
    const sim::Truth& truth = rig.flight->truth();
    truths.push_back(truth);
    for (std::size_t k = 0; k < truth.rotor_count; ++k) {
      const double speed_rad_s = truth.rotor_speed_rad_s[k];
      speeds_rad_s += speed_rad_s / static_cast<double>(truth.rotor_count);
      squares += speed_rad_s * speed_rad_s / static_cast<double>(truth.rotor_count);
    }
  }
  const auto steps = static_cast<double>(truths.size());
  hover.samples = std::move(tap.samples);
  hover.rotor_Hz = speeds_rad_s / steps / (2.0 * std::numbers::pi);
  hover.sigma = kLine * std::sqrt(squares / steps);
  hover.delay_s =
      delay_of(hover.samples, sim::to_seconds(rig.flight->autopilot().boot_time()), truths);
  return hover;
}

/// Power of the three axes within `width_Hz` of a frequency.
double power_near(const Hover& hover, double frequency_Hz, double width_Hz) {
  Spectrum spectrum;
  for (const ImuTap::Sample& sample : hover.samples)
    spectrum.add(sample.rates_rad_s, sample.rates_rad_s);
  const double rate_Hz = static_cast<double>(hover.samples.size() - 1) /
                         (hover.samples.back().t_s - hover.samples.front().t_s);
  const GyroSpectrum s = spectrum.result(rate_Hz);
  const double df_Hz = rate_Hz / static_cast<double>(Spectrum::kSegment);
  double power = 0.0;
  for (std::size_t k = 0; k < s.frequency_Hz.size(); ++k) {
    if (std::abs(s.frequency_Hz[k] - frequency_Hz) <= width_Hz)
      power += s.before[k] * s.before[k] * df_Hz;
  }
  return power;
}

/// Amplitude behind a second-order Butterworth low-pass.
double low_pass(double frequency_Hz, double cut_off_Hz) {
  const double r = frequency_Hz / cut_off_Hz;
  return 1.0 / std::sqrt(1.0 + r * r * r * r);
}
/// Behind the mean of two samples of the gyro.
double mean_of_two(double frequency_Hz) {
  return std::abs(std::cos(std::numbers::pi * frequency_Hz / kGyro_Hz));
}

/// Between samples of the world in steps of 0.5 ms the part sees straight lines: those of a fast oscillation are weaker, and
/// have an image behind 2 kHz, which the gyro folds onto it. (sin x / x)^2 each.
double seen_by_the_part(double frequency_Hz) {
  const auto straight = [](double f_Hz) {
    const double x = std::numbers::pi * f_Hz / kGyro_Hz;
    return std::pow(std::sin(x) / x, 2.0);
  };
  const double image_Hz = kGyro_Hz - frequency_Hz;
  return straight(frequency_Hz) * low_pass(frequency_Hz, kPart_Hz) +
         straight(image_Hz) * low_pass(image_Hz, kPart_Hz);
}

std::vector<std::string> lines(std::vector<std::string> more = {}) {
  more.push_back("sensors.imu.gyro_lines=" + std::to_string(kLine));
  return more;
}

TEST(Vibration, LinesOfRotorAndBladesReachTheControllerThroughTheFilterOfThePart) {
  const Hover hover = fly(2, lines());
  ASSERT_GT(hover.samples.size(), 3500U) << "every sample of the control loop goes over USB";
  const double blade_Hz = 2.0 * hover.rotor_Hz;
  const auto expected = [&hover](double f_Hz, double axes) {
    const double amplitude = low_pass(f_Hz, kPart_Hz) * mean_of_two(f_Hz);
    return axes * hover.sigma * hover.sigma * amplitude * amplitude;
  };
  // The rotors' speeds differ by some percent, and so do their lines.
  EXPECT_NEAR(power_near(hover, hover.rotor_Hz, 12.0) / expected(hover.rotor_Hz, 2.0), 1.0, 0.25);
  EXPECT_NEAR(power_near(hover, blade_Hz, 24.0) / expected(blade_Hz, 1.0), 1.0, 0.25);
  EXPECT_LT(power_near(hover, 300.0, 24.0), 0.02 * power_near(hover, blade_Hz, 24.0));
}

class EachImage : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, EachImage, ::testing::Values("pixracer_pro", "varmint"),
                         [](const auto& board) { return std::string(board.param); });

TEST_P(EachImage, StampsAreThoseOfTheMotion) {
  const Hover hover = fly(2, {"sensors.imu.gyro_lines=0"}, GetParam());
  // The noise of the gyro leaves some 20 us of uncertainty; filter and mean delay by 1.2 ms, on the Varmint by 1.8 ms.
  EXPECT_NEAR(hover.delay_s, 0.0, 100e-6);
}

/// A board that turns about its x axis at a rate that grows evenly, without noise: each sample shows its time.
class Turntable {
 public:
  static constexpr std::int64_t kBegin_us = 3'000'000, kEnd_us = 4'000'000;
  static constexpr double kSlope_rad_s2 = 30.0;

  explicit Turntable(const std::string& board) : chip_{emulated_chip(board)} {
    chip_.start();
    chip_.to_chip().order = boards::stm32h7::ChipOrder::kPowerOn;
    exchange(0);
    chip_.to_chip().order = boards::stm32h7::ChipOrder::kStep;
  }

  /// Stamps less the times that the samples show [us], beginning when the filters have settled.
  std::vector<double> stamp_errors_us() {
    constexpr double kSettled_s = 0.05;
    for (std::int64_t t_us = kChipStep.count(); t_us <= kEnd_us; t_us += kChipStep.count()) {
      exchange(t_us);
      receive(chip_.from_chip());
    }
    std::vector<double> errors_us;
    const auto zero_us = static_cast<double>(chip_.from_chip().clock_zero_us);
    for (const ImuTap::Sample& sample : samples_) {
      const double shown_s = static_cast<double>(sample.rates_rad_s[0]) / kSlope_rad_s2 + kMiddle_s;
      const double stamp_s = sample.t_s + 1e-6 * zero_us;
      if (stamp_s > 1e-6 * kBegin_us + kSettled_s) errors_us.push_back(1e6 * (stamp_s - shown_s));
    }
    return errors_us;
  }

 private:
  static constexpr double kMiddle_s = 0.5e-6 * (kBegin_us + kEnd_us);

  void exchange(std::int64_t t_us) {
    boards::stm32h7::ToChip& order = chip_.to_chip();
    order.time_us = order.until_us = t_us;
    order.usb_plugged = 1;
    order.has_imu = 1;
    order.imu.accel_m_s2 = {0.0F, 0.0F, -static_cast<float>(base::kStandardGravity_m_s2)};
    order.imu.temperature_K = 300.0F;
    const double turns = t_us < kBegin_us ? 0.0 : 1e-6 * static_cast<double>(t_us) - kMiddle_s;
    order.imu.gyro_rad_s = {static_cast<float>(kSlope_rad_s2 * turns), 0.0F, 0.0F};
    chip_.exchange();
  }
  void receive(const boards::stm32h7::FromChip& answer) {
    for (std::size_t at = 0; at < answer.link_count;) {
      const auto decoded = codec_.decode(answer.link.data() + at, answer.link_count - at);
      at += decoded.consumed;
      if (!decoded.complete) continue;
      if (const auto* const imu = std::get_if<link::Imu>(&codec_.message()))
        samples_.push_back({1e-6 * static_cast<double>(imu->time_boot_us), imu->gyro_rad_s});
    }
  }

  boards::stm32h7::ChipProcess chip_;
  std::vector<ImuTap::Sample> samples_;
  link::MavlinkCodec codec_{{1, link::MavlinkCodec::kCompanionComponent}};
};

TEST_P(EachImage, StampsEachSampleWithTheTimeThatItShows) {
  const std::vector<double> errors_us = Turntable{GetParam()}.stamp_errors_us();
  ASSERT_GT(errors_us.size(), 900U);
  // A unit of the BMI088 is 36 us of the motion; bursts of the ADIS16500 have 32 bits.
  const double resolution_us = std::string(GetParam()) == "varmint" ? 0.01 : 36.0;
  double sum_us = 0.0;
  for (const double error_us : errors_us) {
    sum_us += error_us;
    EXPECT_NEAR(error_us, 0.0, 0.5 * resolution_us + 2.0);
  }
  EXPECT_NEAR(sum_us / static_cast<double>(errors_us.size()), 0.0, 2.0);
}

TEST(Vibration, WhatFoldsIsTakenAwayByAFilterAtTheRateOfTheGyro) {
  constexpr int kBlades = 12;
  const Hover open = fly(kBlades, lines());
  const double blade_Hz = kBlades * open.rotor_Hz;  // 810 Hz: beyond half of the control rate
  const double folded_Hz = kControl_Hz - blade_Hz;
  const double amplitude = seen_by_the_part(blade_Hz) * mean_of_two(blade_Hz);
  const double expected = open.sigma * open.sigma * amplitude * amplitude;
  constexpr double kWidth_Hz = 90.0;  // twelve times the spread of the rotors
  const double folded = power_near(open, folded_Hz, kWidth_Hz);
  const Hover still = fly(kBlades, {"sensors.imu.gyro_lines=0"});
  const double noise = power_near(still, folded_Hz, kWidth_Hz);
  EXPECT_NEAR((folded - noise) / expected, 1.0, 0.4);

  constexpr double kCutOff_Hz = 80.0;
  const Hover filtered = fly(kBlades, lines({"firmware.GYRO_LPF_HZ=80"}));
  // The filter leaves 1 % of what would fold, and of the noise there.
  EXPECT_LT(power_near(filtered, folded_Hz, kWidth_Hz), 0.1 * folded);
  const double kept = low_pass(open.rotor_Hz, kCutOff_Hz);
  EXPECT_NEAR(power_near(filtered, filtered.rotor_Hz, 12.0) / power_near(open, open.rotor_Hz, 12.0),
              kept * kept, 0.25 * kept * kept);
}

}  // namespace
}  // namespace rosflight::flight::testing
