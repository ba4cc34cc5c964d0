// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/bmi088.hpp"

#include <algorithm>

#include "base/constants.hpp"
#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

// Accelerometer.
constexpr std::uint8_t kAccId = 0x00, kAccIdValue = 0x1E;
constexpr std::uint8_t kAccData = 0x12;
constexpr std::uint8_t kAccTemperature = 0x22;
constexpr std::uint8_t kAccConf = 0x40, kAcc1600HzNormal = 0xAC;
constexpr std::uint8_t kAccRange = 0x41;
constexpr std::uint8_t kAccPowerConf = 0x7C, kAccActive = 0x00;
constexpr std::uint8_t kAccPowerControl = 0x7D, kAccOn = 0x04;
constexpr std::uint8_t kAccReset = 0x7E;
// Gyro.
constexpr std::uint8_t kGyroId = 0x00, kGyroIdValue = 0x0F;
constexpr std::uint8_t kGyroData = 0x02;
constexpr std::uint8_t kGyroRangeRegister = 0x0F;
constexpr std::uint8_t kGyroBandwidth = 0x10;
constexpr std::uint8_t kGyroPower = 0x11, kGyroNormal = 0x00;
constexpr std::uint8_t kGyroReset = 0x14;
constexpr std::uint8_t kGyroInterrupt = 0x15, kNewData = 0x80;
constexpr std::uint8_t kGyroPins = 0x16, kPushPullHigh = 0x05;  // INT3 and INT4
constexpr std::uint8_t kGyroMap = 0x18, kToInt3 = 0x01;
constexpr std::uint8_t kSoftReset = 0xB6;

constexpr std::uint8_t kRead = 0x80;
constexpr Time kTemperaturePeriod = hal::milliseconds(1280);
constexpr std::uint8_t kEmptyInARow = 20;

constexpr float kRadPerDeg = static_cast<float>(base::kRadPerDeg);
constexpr float kGravity_m_s2 = static_cast<float>(base::kStandardGravity_m_s2);

float full_scale_rad_s(Bmi088::GyroRange range) {
  return 2000.0f / static_cast<float>(1u << static_cast<unsigned>(range)) * kRadPerDeg;
}
float full_scale_m_s2(Bmi088::AccelRange range) {
  return 3.0f * static_cast<float>(1u << static_cast<unsigned>(range)) * kGravity_m_s2;
}

hal::Vec3 scaled(const std::array<std::uint8_t, 6>& raw, float scale) {
  return {static_cast<float>(le16(&raw[0])) * scale, static_cast<float>(le16(&raw[2])) * scale,
          static_cast<float>(le16(&raw[4])) * scale};
}

}  // namespace

Time Bmi088::group_delay(GyroRate rate) {
  constexpr std::array<float, 4> kBandwidth_hz{532.0f, 230.0f, 116.0f, 47.0f};
  constexpr float kSqrt2OverTwoPi = 0.22507908f;
  const float delay_us = 1e6f * kSqrt2OverTwoPi / kBandwidth_hz[static_cast<std::size_t>(rate)];
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): never negative
  return Time{static_cast<std::int64_t>(delay_us + 0.5f)};
}

/// Behind each reset the accelerometer listens to I2C again until its chip select rises once; the
/// read that does this returns nothing.
std::array<SetupStep, Bmi088::kAccelSteps> Bmi088::accel_steps(const Config& config) {
  using K = SetupKind;
  return {{{K::kVoid, kAccId},
           {K::kWrite, kAccReset, kSoftReset, 0xFF, 1000},
           {K::kVoid, kAccId},
           {K::kIdentity, kAccId, kAccIdValue},
           {K::kConfigure, kAccPowerConf, kAccActive, 0xFF, 5000},
           {K::kConfigure, kAccPowerControl, kAccOn, 0xFF, 50'000},
           {K::kConfigure, kAccConf, kAcc1600HzNormal, 0xFF, 2},
           {K::kConfigure, kAccRange, static_cast<std::uint8_t>(config.accel_range), 0x03, 2},
           {K::kIdentity, kAccId, kAccIdValue}}};
}

std::array<SetupStep, Bmi088::kGyroSteps> Bmi088::gyro_steps(const Config& config) {
  using K = SetupKind;
  return {
      {{K::kWrite, kGyroReset, kSoftReset, 0xFF, 30'000},
       {K::kIdentity, kGyroId, kGyroIdValue},
       {K::kConfigure, kGyroPower, kGyroNormal, 0xFF, 30'000},
       {K::kConfigure, kGyroRangeRegister, static_cast<std::uint8_t>(config.gyro_range), 0x07, 2},
       // Bit 7 always reads 1.
       {K::kConfigure, kGyroBandwidth, static_cast<std::uint8_t>(config.gyro_rate), 0x0F, 2},
       {K::kConfigure, kGyroPins, kPushPullHigh, 0x0F, 2},
       {K::kConfigure, kGyroMap, kToInt3, 0x81, 2},
       {K::kConfigure, kGyroInterrupt, kNewData, 0x80, 2}}};
}

Bmi088::Bmi088(Port& accel, Port& gyro, const Config& config)
    : Driver{"BMI088"},
      config_{config},
      accel_{accel},
      gyro_{gyro},
      accel_steps_{accel_steps(config)},
      gyro_steps_{gyro_steps(config)},
      accel_setup_{accel, {kRead, 1}, accel_steps_},
      gyro_setup_{gyro, {kRead, 0}, gyro_steps_},
      accel_scale_m_s2_{full_scale_m_s2(config.accel_range) / 32768.0f},
      gyro_scale_rad_s_{full_scale_rad_s(config.gyro_range) / 32768.0f},
      delay_{group_delay(config.gyro_rate)} {}

bool Bmi088::begin(Start how, Time now) {
  // Both or none; a begun set-up may be begun again.
  temperature_K_ = hal::ImuSample{}.temperature_K;
  temperature_at_ = now - kTemperaturePeriod;
  empty_in_a_row_ = 0;
  const bool accel = accel_setup_.begin(how, now);
  const bool gyro = gyro_setup_.begin(how, now);
  return accel && gyro;
}

void Bmi088::step_start(Time now) {
  accel_setup_.step(now);
  gyro_setup_.step(now);
  using S = Setup::Status;
  if (accel_setup_.status() == S::kFailed) {
    Text text = fail(now);
    accel_setup_.describe(text.add("accelerometer: "));
  } else if (gyro_setup_.status() == S::kFailed) {
    Text text = fail(now);
    gyro_setup_.describe(text.add("gyro: "));
  } else if (accel_setup_.status() == S::kDone && gyro_setup_.status() == S::kDone) {
    last_edge_ = now;
    started();
  }
}

void Bmi088::step_running(Time now) {
  if (now - last_edge_ >= kEdgeTimeout) fail(now).add("no data ready");
}

void Bmi088::data_ready(Time edge) {
  if (state() != PartState::kRunning) return;
  last_edge_ = edge;
  if (stage_ != Stage::kIdle) {
    ++overruns_;
    return;
  }
  edge_ = edge;
  read(Stage::kAccel, accel_, kAccData, 1, raw_accel_.size());
}

void Bmi088::read(Stage stage, Port& port, std::uint8_t reg, std::size_t dummy, std::size_t count) {
  std::uint8_t* const in = stage == Stage::kAccel  ? raw_accel_.data()
                           : stage == Stage::kGyro ? raw_gyro_.data()
                                                   : raw_temperature_.data();
  out_ = {static_cast<std::uint8_t>(reg | kRead), 0};
  transfer_ = {out_.data(), 1 + dummy, in, count, this};
  stage_ = port.start(transfer_) ? stage : Stage::kIdle;
}

void Bmi088::transfer_done(Transfer& /*transfer*/, TransferResult result, Time end) {
  const Stage ended = stage_;
  stage_ = Stage::kIdle;
  if (!good(result, end) || state() != PartState::kRunning) return;
  if (ended == Stage::kAccel) {
    read(Stage::kGyro, gyro_, kGyroData, 0, raw_gyro_.size());
  } else if (ended == Stage::kGyro) {
    hand_over(end);
  } else {
    const unsigned raw = raw_temperature_[0] * 8u + (raw_temperature_[1] >> 5);
    temperature_K_ = kZeroCelsius_K + 23.0f + 0.125f * static_cast<float>(sign_extend(raw, 11));
  }
}

/// An accelerometer that lost its set-up measures nothing: exactly 0 on all axes.
void Bmi088::hand_over(Time now) {
  const bool empty =
      std::all_of(raw_accel_.begin(), raw_accel_.end(), [](auto b) { return b == 0; });
  empty_in_a_row_ = empty ? static_cast<std::uint8_t>(empty_in_a_row_ + 1) : 0;
  if (empty_in_a_row_ >= kEmptyInARow) {
    fail(now).add("accelerometer is off");
    return;
  }
  hal::ImuSample sample;
  sample.stamp = edge_ - delay_;
  sample.accel_m_s2 = config_.mounting.apply(scaled(raw_accel_, accel_scale_m_s2_));
  sample.gyro_rad_s = config_.mounting.apply(scaled(raw_gyro_, gyro_scale_rad_s_));
  sample.temperature_K = temperature_K_;
  static_cast<void>(samples_.put(sample));
  well();
  if (now - temperature_at_ < kTemperaturePeriod) return;
  temperature_at_ = now;
  read(Stage::kTemperature, accel_, kAccTemperature, 1, raw_temperature_.size());
}

}  // namespace rosflight::boards::parts
