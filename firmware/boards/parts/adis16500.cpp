// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/adis16500.hpp"

#include "base/constants.hpp"
#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kStatus = 0x02;
constexpr std::uint8_t kFilter = 0x5C;
constexpr std::uint8_t kMisc = 0x60;
// 32-bit burst, compensation of linear acceleration, direct synchronization, data ready active high.
constexpr std::uint16_t kMiscValue = 0x0285;
constexpr std::uint8_t kDecimation = 0x64;
constexpr std::uint8_t kProduct = 0x72;
constexpr std::uint16_t kProductValue = 0x4074;
constexpr std::uint8_t kBurst = 0x68;
constexpr std::uint8_t kWrite = 0x80;

constexpr std::uint16_t kSync_hz = 2000;
constexpr Time kResetTime = hal::milliseconds(350);
constexpr std::uint8_t kAttempts = 4;
constexpr std::uint8_t kBadInARow = 20;

constexpr float kGyroLsb_rad_s = 0.1f / 65536.0f * static_cast<float>(base::kRadPerDeg);
constexpr float kAccelLsb_m_s2 = 0.01225f / 65536.0f;

std::uint16_t sum_of(const std::uint8_t* data, std::size_t size) {
  unsigned sum = 0;
  for (std::size_t k = 0; k < size; ++k) sum += data[k];
  return static_cast<std::uint16_t>(sum);
}

/// Lower word first.
float value(const std::uint8_t* p) {
  const std::uint32_t bits = static_cast<std::uint32_t>(be16(p + 2)) << 16 | be16(p);
  return static_cast<float>(static_cast<std::int32_t>(bits));
}

}  // namespace

Time Adis16500::group_delay(std::uint16_t rate_hz) {
  return Time{1510 + 500'000 / rate_hz - 250};
}

Adis16500::Adis16500(Port& port, OutputPin& reset, const Config& config)
    : Driver{"ADIS16500"},
      port_{port},
      reset_{reset},
      config_{config},
      rows_{{{kProduct, kProductValue, false},
             {kStatus, 0, false},
             {kFilter, 0, true},
             {kDecimation, static_cast<std::uint16_t>(kSync_hz / config.rate_hz - 1), true},
             {kMisc, kMiscValue, true}}},
      delay_{group_delay(config.rate_hz)} {}

bool Adis16500::begin(Start how, Time now) {
  if (on_bus_) return false;
  how_ = how;
  row_ = 0;
  attempts_ = 0;
  bad_in_a_row_ = 0;
  if (how == Start::kCold) {
    reset_.set(false);
    stage_ = Stage::kResetLow;
    wait_until_ = now + Time{100};
  } else {
    reset_.set(true);
    stage_ = Stage::kAsk;
    wait_until_ = now;
  }
  return true;
}

void Adis16500::step_start(Time now) {
  if (on_bus_ || now < wait_until_) return;
  const Row& row = rows_[row_];
  switch (stage_) {
    case Stage::kResetLow:
      reset_.set(true);
      stage_ = Stage::kResetHigh;
      wait_until_ = now + kResetTime;
      break;
    case Stage::kResetHigh:
      stage_ = Stage::kAsk;
      send_word(row.reg, 0);
      break;
    case Stage::kWriteLow:
      send_word(kWrite | row.reg, row.value & 0xFFu);
      break;
    case Stage::kWriteHigh:
      send_word(static_cast<std::uint8_t>(kWrite | (row.reg + 1)),
                static_cast<std::uint8_t>(row.value >> 8));
      break;
    case Stage::kAsk:
      send_word(row.reg, 0);
      break;
    case Stage::kAnswer:
      transfer_ = {nullptr, 0, in_.data(), 2, this};
      on_bus_ = port_.start(transfer_);
      break;
    case Stage::kIdle:
    case Stage::kBurst:
      break;
  }
}

void Adis16500::send_word(std::uint8_t first, std::uint8_t second) {
  out_ = {first, second};
  transfer_ = {out_.data(), 2, nullptr, 0, this};
  on_bus_ = port_.start(transfer_);
}

void Adis16500::step_running(Time now) {
  if (now - last_edge_ >= kEdgeTimeout) fail(now).add("no data ready");
}

void Adis16500::data_ready(Time edge) {
  if (state() != PartState::kRunning) return;
  last_edge_ = edge;
  if (on_bus_) {
    ++overruns_;
    return;
  }
  edge_ = edge;
  out_ = {kBurst, 0};
  transfer_ = {out_.data(), 2, in_.data(), kBurstBytes, this};
  on_bus_ = port_.start(transfer_);
  stage_ = Stage::kBurst;
}

void Adis16500::transfer_done(Transfer& /*transfer*/, TransferResult result, Time end) {
  on_bus_ = false;
  if (state() == PartState::kStarting && result != TransferResult::kDone) {
    fail(end).add(result == TransferResult::kTimeout ? "bus stuck" : "bus fault");
    return;
  }
  if (!good(result, end) || state() == PartState::kFailed) return;
  switch (stage_) {
    case Stage::kWriteLow:
      stage_ = Stage::kWriteHigh;
      break;
    case Stage::kWriteHigh:
      stage_ = Stage::kAsk;
      break;
    case Stage::kAsk:
      stage_ = Stage::kAnswer;
      break;
    case Stage::kAnswer:
      answered(end);
      break;
    case Stage::kBurst:
      use_burst(end);
      break;
    case Stage::kResetLow:
    case Stage::kResetHigh:
    case Stage::kIdle:
      break;
  }
}

void Adis16500::answered(Time now) {
  const Row& row = rows_[row_];
  const std::uint16_t found = be16(in_.data());
  if (found == row.value) {
    next_row();
    if (row_ < kRows) return;
    last_edge_ = now;
    stage_ = Stage::kIdle;
    started();
  } else if (row.configure && attempts_ < kAttempts) {
    ++attempts_;
    stage_ = Stage::kWriteLow;
  } else if (row.reg == kProduct) {
    fail(now).add("identity ").hex(found, 4).add(", expected ").hex(kProductValue, 4);
  } else {
    fail(now)
        .add("register ")
        .hex(row.reg)
        .add(" is ")
        .hex(found, 4)
        .add(", expected ")
        .hex(row.value, 4);
  }
}

/// After a reset every register is written, whatever it reads.
void Adis16500::next_row() {
  ++row_;
  attempts_ = 0;
  stage_ = Stage::kAsk;
  if (row_ < kRows && rows_[row_].configure && how_ == Start::kCold) stage_ = Stage::kWriteLow;
}

void Adis16500::use_burst(Time now) {
  const std::uint16_t status = be16(&in_[0]);
  const bool intact = sum_of(in_.data(), kBurstBytes - 2) == be16(&in_[kBurstBytes - 2]);
  if (!intact || status != 0) {
    count_error();
    if (++bad_in_a_row_ < kBadInARow) return;
    if (intact) {
      fail(now).add("status ").hex(status, 4);
    } else {
      fail(now).add("checksums are wrong");
    }
    return;
  }
  bad_in_a_row_ = 0;
  hal::ImuSample sample;
  sample.stamp = edge_ - delay_;
  hal::Vec3 gyro{};
  hal::Vec3 accel{};
  for (std::size_t k = 0; k < 3; ++k) {
    gyro[k] = kGyroLsb_rad_s * value(&in_[2 + 4 * k]);
    accel[k] = kAccelLsb_m_s2 * value(&in_[14 + 4 * k]);
  }
  sample.gyro_rad_s = config_.mounting.apply(gyro);
  sample.accel_m_s2 = config_.mounting.apply(accel);
  sample.temperature_K =
      kZeroCelsius_K + 0.1f * static_cast<float>(static_cast<std::int16_t>(be16(&in_[26])));
  static_cast<void>(samples_.put(sample));
  well();
}

}  // namespace rosflight::boards::parts
