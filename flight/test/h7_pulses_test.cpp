// SPDX-License-Identifier: BSD-3-Clause
// The pulses that the boards with an STM32H7 make on every output at every rate: an image whose outputs this test
// orders, on the emulated chip. What its timers make on the pins is compared with the definition of PWM and DShot.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "firmware/boards/stm32h7/test/output_order.hpp"
#include "flight/autopilot/chip_autopilot.hpp"

namespace rosflight::flight::testing {
namespace {

using boards::stm32h7::ChipOrder;
using boards::stm32h7::ChipProcess;
using boards::stm32h7::OutputOrder;
using boards::stm32h7::PinSignal;

constexpr std::int64_t kStep_us = 1000;
constexpr std::uint32_t kBaud = 921'600;

/// Outputs of one timer, which have one rate: the last of each, from 0.
struct Wiring {
  std::string board;
  std::vector<std::size_t> last_of_group;

  std::size_t outputs() const { return last_of_group.back() + 1; }
  std::size_t group(std::size_t output) const {
    std::size_t g = 0;
    while (last_of_group[g] < output) ++g;
    return g;
  }
};

ChipProcess::Options outputs_image(const std::string& board) {
  ChipProcess::Options options = emulated_chip(board);
  options.image.replace_filename("firmware_" + board + "_outputs.elf");
  return options;
}

/// A board that obeys. A complaint of a model, such as of a DShot train that is no frame, is an exception.
class Bench {
 public:
  explicit Bench(const std::string& board) : chip_{outputs_image(board)} {
    chip_.start();
    chip_.to_chip().order = ChipOrder::kPowerOn;
    run(kStep_us);
    chip_.to_chip().order = ChipOrder::kStep;
    run(20 * kStep_us);
  }

  /// @returns the answer of the image; 0: it did not answer.
  char obey(const OutputOrder& order) {
    std::memcpy(chip_.to_chip().link.data(), &order, sizeof order);
    chip_.to_chip().link_count = sizeof order;
    constexpr int kTimeout = 20;  // steps
    for (int k = 0; k < kTimeout; ++k) {
      run(kStep_us);
      if (chip_.from_chip().link_count > 0) return static_cast<char>(chip_.from_chip().link[0]);
    }
    return 0;
  }
  void run(std::int64_t duration_us) {
    chip_.to_chip().link_baud = kBaud;
    chip_.to_chip().time_us = now_us_;
    chip_.to_chip().until_us = now_us_ += duration_us;
    chip_.exchange();
    chip_.to_chip().link_count = 0;
  }
  const PinSignal& pin(std::size_t output) const { return chip_.from_chip().signals[output]; }

 private:
  ChipProcess chip_;
  std::int64_t now_us_{0};
};

bool is_dshot(float rate_hz) {
  return rate_hz > 1000.0F;
}

/// PWM: 1000 us for 0 and 2000 us for 1, once in each period.
void expect_pwm(const PinSignal& pin, double rate_hz, double value) {
  constexpr double kMinCounts = 32'768.0;  // finer does not fit 16 bits
  EXPECT_GT(pin.period_s / pin.count_s, kMinCounts);
  EXPECT_NEAR(pin.period_s, 1.0 / rate_hz, pin.count_s);
  EXPECT_NEAR(pin.high_s, 1e-3 + 1e-3 * value, pin.count_s);
}

/// DShot: 11 bits of throttle, the request for telemetry, and a checksum that makes the xor of the four nibbles 0; a 1 is
/// high for 3/4 of a bit, a 0 for 3/8.
void expect_dshot(const PinSignal& pin, double rate_hz, double value) {
  EXPECT_NEAR(pin.count_s, 5e-9, 1e-15) << "the timer counts undivided";
  EXPECT_NEAR(pin.period_s, 1.0 / rate_hz, pin.count_s);
  EXPECT_EQ(pin.high_s, 0.0);
  unsigned frame = 0;
  for (const std::uint32_t counts : pin.dshot_high) {
    const double high_s = counts * pin.count_s;
    const bool one = high_s * rate_hz > 9.0 / 16.0;
    EXPECT_NEAR(high_s, (one ? 0.75 : 0.375) / rate_hz, pin.count_s);
    frame = frame << 1U | (one ? 1U : 0U);
  }
  EXPECT_EQ((frame >> 12U ^ frame >> 8U ^ frame >> 4U ^ frame) & 0xFU, 0U);
  EXPECT_EQ(frame >> 4U & 1U, 0U) << "no telemetry is asked for";
  const double throttle = value > 0.0 ? 48.0 + 1999.0 * value : 0.0;
  EXPECT_NEAR(frame >> 5U, throttle, 0.51);
}

class PulsesOf : public ::testing::TestWithParam<Wiring> {
 protected:
  /// Each output at the rate of its timer, with its value.
  void expect_pins(const OutputOrder& order, const std::vector<std::uint32_t>& frames_before) {
    for (std::size_t k = 0; k < GetParam().outputs(); ++k) {
      const float rate_hz = order.rates_hz[k];
      SCOPED_TRACE("output " + std::to_string(k + 1) + " at " + std::to_string(rate_hz) + " Hz");
      const auto value = static_cast<double>(order.values[k]);
      if (is_dshot(rate_hz)) {
        EXPECT_EQ(bench_.pin(k).dshot_frames, frames_before[k] + 1);
        expect_dshot(bench_.pin(k), static_cast<double>(rate_hz), value);
      } else {
        expect_pwm(bench_.pin(k), static_cast<double>(rate_hz), value);
      }
    }
  }
  std::vector<std::uint32_t> frames() const {
    std::vector<std::uint32_t> out;
    out.reserve(GetParam().outputs());
    for (std::size_t k = 0; k < GetParam().outputs(); ++k)
      out.push_back(bench_.pin(k).dshot_frames);
    return out;
  }

  Bench bench_{GetParam().board};
};
INSTANTIATE_TEST_SUITE_P(Boards, PulsesOf,
                         ::testing::Values(Wiring{"pixracer_pro", {3, 5, 7}},
                                           Wiring{"varmint", {3, 7, 9}}),
                         [](const auto& wiring) { return wiring.param.board; });

/// Each timer goes through all rates, and the three have different ones at any time.
TEST_P(PulsesOf, AreWithinOneCountOnEveryOutputAtEveryRate) {
  std::vector<float> rates{50.0F,  60.0F, 100.0F, 200.0F,     250.0F,     333.0F,      400.0F,
                           490.0F, 4.0F,  150e3F, 300'000.0F, 600'000.0F, 1'200'000.0F};
  std::mt19937 random{17};  // NOLINT(bugprone-random-generator-seed): repeatable
  std::uniform_real_distribution<float> any_rate{4.0F, 490.0F}, any_value{0.0F, 1.0F};
  constexpr std::size_t kOddRates = 20;
  for (std::size_t k = 0; k < kOddRates; ++k) rates.push_back(any_rate(random));
  for (std::size_t round = 0; round < rates.size(); ++round) {
    OutputOrder order;
    for (std::size_t k = 0; k < GetParam().outputs(); ++k) {
      constexpr std::size_t kApart = 5;
      order.rates_hz[k] = rates[(round + kApart * GetParam().group(k)) % rates.size()];
      order.values[k] = any_value(random);
    }
    order.values[round % GetParam().outputs()] = 0.0F;
    order.values[(round + 1) % GetParam().outputs()] = 1.0F;
    const std::vector<std::uint32_t> before = frames();
    ASSERT_EQ(bench_.obey(order), OutputOrder::kGiven) << "round " << round;
    const auto last = order.rates_hz.begin() + static_cast<std::ptrdiff_t>(GetParam().outputs());
    const float slowest_hz = *std::min_element(order.rates_hz.begin(), last);
    bench_.run(static_cast<std::int64_t>(2.1e6F / slowest_hz) + kStep_us);
    expect_pins(order, before);
  }
}

TEST_P(PulsesOf, TwoRatesOnOneTimerAreRefusedAndItRunsAtTheSlower) {
  OutputOrder order;
  order.rates_hz.fill(50.0F);
  order.rates_hz[0] = 400.0F;
  order.values.fill(0.25F);
  EXPECT_EQ(bench_.obey(order), OutputOrder::kRefused);
  bench_.run(50'000);
  order.rates_hz[0] = 50.0F;
  expect_pins(order, frames());
}

TEST_P(PulsesOf, AtRateZeroThereAreNone) {
  OutputOrder order;
  order.values.fill(0.5F);
  EXPECT_EQ(bench_.obey(order), OutputOrder::kGiven);
  bench_.run(50'000);
  for (std::size_t k = 0; k < GetParam().outputs(); ++k) {
    EXPECT_EQ(bench_.pin(k).high_s, 0.0) << k;
    EXPECT_EQ(bench_.pin(k).dshot_frames, 0U) << k;
  }
}

}  // namespace
}  // namespace rosflight::flight::testing
