// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gyro_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "flight/flight_recorder.hpp"
#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr hal::Time kPeriod = hal::microseconds(2500);

hal::ImuSample sample(int k, float x) {
  hal::ImuSample out;
  out.stamp = k * kPeriod;
  out.gyro_rad_s = {x, 0.0F, 0.0F};
  return out;
}

link::Attitude rates(int k, float x) {
  link::Attitude out;
  out.time_boot_ms = static_cast<std::uint32_t>(hal::to_ms(k * kPeriod));
  out.rates_rad_s = {x, 0.0F, 0.0F};
  return out;
}

TEST(GyroRecord, PairsByStampWhateverTheLinkIsLate) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise;
  GyroRecord record;
  std::vector<float> sent;
  constexpr int kLate = 20;  // 50 ms
  for (int k = 0; k < 4000; ++k) {
    sent.push_back(noise(random));
    record.sent(sample(k, sent.back()));
    record.sent(sample(k, sent.back()));
    // The firmware delays by one sample; the link by many.
    const int old = k - kLate;
    if (old > 0) record.received(rates(old, sent[static_cast<std::size_t>(old - 1)]));
  }
  const GyroSpectrum spectrum = record.spectrum();
  ASSERT_FALSE(spectrum.frequency_Hz.empty());
  EXPECT_NEAR(spectrum.frequency_Hz.back(), 200.0, 1e-9);
  EXPECT_NEAR(spectrum.latency_s, 0.0025, 1e-4);
}

TEST(GyroRecord, UnknownStampsAndRestartsOfTheClockBreakNothing) {
  GyroRecord record;
  record.received(rates(7, 1.0F));
  EXPECT_TRUE(record.spectrum().frequency_Hz.empty());
  for (int start : {1000, 0, 1000}) {
    for (int k = start; k < start + 600; ++k) {
      record.sent(sample(k, 0.001F * static_cast<float>(k % 7)));
      if (k % 100 != 99) record.received(rates(k, 0.0F));
      record.received(rates(k + 50, 0.0F));  // from the future
    }
  }
  EXPECT_TRUE(record.spectrum().frequency_Hz.empty()) << "no 256 samples join";
}

TEST(GyroRecord, TheAnalysisOfAFlightHasTheSpectrumAndItsLatency) {
  const auto folder = std::filesystem::temp_directory_path() / "rosflight_gyro_record";
  std::filesystem::create_directories(folder);
  FlightChoice choice;
  choice.mission = "hop";
  Rig rig(choice);
  FlightRecorder recorder(*rig.flight, folder / "flight.mcap");
  rig.flight->run();
  recorder.close();
  std::filesystem::remove_all(folder);
  const GyroSpectrum& gyro = recorder.analysis().gyro;
  ASSERT_FALSE(gyro.frequency_Hz.empty());
  EXPECT_NEAR(gyro.frequency_Hz.back(), 200.0, 1e-6);
  // GYRO_XY_LPF and GYRO_Z_LPF are 0.3 by default: 0.3 / 0.7 samples of delay, and at half the
  // sampling rate 0.7 / 1.3 of the amplitude.
  EXPECT_NEAR(gyro.latency_s, 0.3 / 0.7 / 400.0, 0.1e-3);
  EXPECT_NEAR(gyro.after.back() / gyro.before.back(), 0.7 / 1.3, 0.05);
  ASSERT_TRUE(recorder.counters());
  EXPECT_GT(recorder.counters()->passes, 1000U);
}

}  // namespace
}  // namespace rosflight::flight::testing
