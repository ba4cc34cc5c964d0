// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/models/bmi088_model.hpp"

#include <algorithm>

namespace rosflight::boards::parts::models {
namespace {

constexpr double kInternal_hz = 8000.0;
constexpr Time kLineHigh{300};
constexpr std::uint8_t kSoftReset = 0xB6;

std::int16_t counts(double value, double full_scale) {
  return static_cast<std::int16_t>(
      std::clamp(std::lround(value / full_scale * 32768.0), -32768l, 32767l));
}

void put(RegisterFile& registers, unsigned reg, std::int16_t value) {
  registers[static_cast<std::uint8_t>(reg)] = static_cast<std::uint8_t>(value & 0xFF);
  registers[static_cast<std::uint8_t>(reg + 1)] = static_cast<std::uint8_t>((value >> 8) & 0xFF);
}

double accel_bandwidth_hz(std::uint8_t conf) {
  // Normal filter: 280 Hz at 1600 samples per second (of the axes, z is somewhat lower), and in
  // proportion to the rate below; OSR2 and OSR4 halve and quarter it.
  const double rate = 12.5 * static_cast<double>(1u << ((conf & 0x0Fu) - 5u));
  const unsigned filter = conf >> 4;
  return 0.175 * rate / (filter == 0x8 ? 4.0 : filter == 0x9 ? 2.0 : 1.0);
}

struct GyroMode {
  double rate_hz;
  double bandwidth_hz;
};
GyroMode gyro_mode(std::uint8_t bandwidth) {
  constexpr std::array<GyroMode, 8> kModes{{{2000, 532},
                                            {2000, 230},
                                            {1000, 116},
                                            {400, 47},
                                            {200, 23},
                                            {100, 12},
                                            {200, 64},
                                            {100, 32}}};
  return kModes[bandwidth & 0x07u];
}

}  // namespace

// ---- accelerometer

Bmi088Model::Accelerometer::Accelerometer(const Exposure& exposure, const double& clock_error)
    : SpiRegisters{1}, exposure_{exposure}, clock_error_{clock_error} {
  reset(Time{});
}

void Bmi088Model::Accelerometer::reset(Time now) {
  registers.clear();
  registers[0x00] = 0x1E;
  registers[0x40] = 0xA8;  // 100 Hz
  registers[0x41] = 0x01;  // 6 g
  registers[0x7C] = 0x03;  // suspended
  spi_ = false;
  ready_ = now + Time{1000};
}

void Bmi088Model::Accelerometer::set_power(bool on) {
  powered_ = on;
  if (on) reset(now_);
}

/// The reset takes place behind the transfer that commands it.
void Bmi088Model::Accelerometer::deselected() {
  spi_ = true;
  if (reset_commanded_) reset(now_);
  reset_commanded_ = false;
}

std::uint8_t Bmi088Model::Accelerometer::read_register(std::uint8_t reg) {
  if (now_ < ready_ && reg != 0x00) complain("accelerometer read before it was ready");
  if (!spi_ || now_ < ready_) return 0x00;
  return registers[reg];
}

void Bmi088Model::Accelerometer::write_register(std::uint8_t reg, std::uint8_t value) {
  if (reg == 0x7E && value == kSoftReset) {
    reset_commanded_ = true;
    return;
  }
  if (now_ < ready_) complain("accelerometer written before it was ready");
  if (!spi_ || now_ < ready_ || reg < 0x40) return;
  registers[reg] = value;
  if (reg == 0x7C || reg == 0x7D) {
    ready_ = now_ + Time{450};
    next_ = now_;
    phase_us_ = static_cast<double>(now_.count());
    internal_ = 0;
  }
}

void Bmi088Model::Accelerometer::advance(Time now) {
  while (on() && next_ <= now) {
    now_ = next_;
    sample();
    phase_us_ += 1e6 / kInternal_hz * (1.0 + clock_error_);
    next_ = Time{std::llround(phase_us_)};
  }
  now_ = now;
}

void Bmi088Model::Accelerometer::sample() {
  const std::uint8_t conf = registers[0x40];
  const double rate = 12.5 * static_cast<double>(1u << ((conf & 0x0Fu) - 5u));
  const auto every = static_cast<unsigned>(std::lround(kInternal_hz / rate));
  const ImuTruth truth = exposure_(now_);
  const double range = 3.0 * (1u << (registers[0x41] & 3u)) * base::kStandardGravity_m_s2;
  const bool out = internal_++ % every == 0;
  for (std::size_t k = 0; k < 3; ++k) {
    filter_[k].configure(accel_bandwidth_hz(conf), kInternal_hz);
    const double y = filter_[k].step(truth.accel_m_s2[k]);
    if (out) put(registers, 0x12u + 2u * static_cast<unsigned>(k), counts(y, range));
  }
  const auto celsius = std::lround((truth.temperature_K - 273.15 - 23.0) / 0.125);
  const auto raw = static_cast<unsigned>(std::clamp(celsius, -1023l, 1023l)) & 0x7FFu;
  registers[0x22] = static_cast<std::uint8_t>(raw >> 3);
  registers[0x23] = static_cast<std::uint8_t>((raw & 7u) << 5);
  const auto ticks = static_cast<std::uint32_t>(static_cast<double>(now_.count()) / 39.0625);
  for (unsigned k = 0; k < 3; ++k) {
    registers[static_cast<std::uint8_t>(0x18u + k)] = static_cast<std::uint8_t>(ticks >> (8 * k));
  }
}

// ---- gyro

Bmi088Model::Gyro::Gyro(const Exposure& exposure, const double& clock_error)
    : exposure_{exposure}, clock_error_{clock_error} {
  reset(Time{});
}

void Bmi088Model::Gyro::reset(Time now) {
  registers.clear();
  registers[0x00] = 0x0F;
  registers[0x10] = 0x80;
  registers[0x16] = 0x0F;  // open drain, active high
  ready_ = now + hal::milliseconds(30);
  next_ = ready_;
  phase_us_ = static_cast<double>(next_.count());
  internal_ = 0;
  line_falls_ = kNever;
}

void Bmi088Model::Gyro::set_power(bool on) {
  powered_ = on;
  if (on) reset(now_);
}

std::uint8_t Bmi088Model::Gyro::read_register(std::uint8_t reg) {
  if (now_ < ready_) {
    complain("gyro read before it was ready");
    return 0xFF;
  }
  return registers[reg];
}

void Bmi088Model::Gyro::write_register(std::uint8_t reg, std::uint8_t value) {
  if (reg == 0x14 && value == kSoftReset) {
    reset(now_);
    return;
  }
  if (now_ < ready_) {
    complain("gyro written before it was ready");
    return;
  }
  if (reg < 0x0F) return;
  if (reg == 0x11 && value != registers[0x11]) ready_ = now_ + hal::milliseconds(30);
  registers[reg] = static_cast<std::uint8_t>(reg == 0x10 ? value | 0x80u : value);
}

Time Bmi088Model::Gyro::next_event() const {
  return on() ? std::min(next_, line_falls_) : kNever;
}

void Bmi088Model::Gyro::advance(Time now) {
  while (on() && next_event() <= now) {
    if (line_falls_ <= next_) {
      now_ = line_falls_;
      line_falls_ = kNever;
      if (line) line(false, now_);
      continue;
    }
    now_ = next_;
    sample(now_);
    phase_us_ += 1e6 / kInternal_hz * (1.0 + clock_error_);
    next_ = Time{std::llround(phase_us_)};
  }
  now_ = now;
}

double Bmi088Model::Gyro::delay_us() const {
  return filter_[0].delay() * 1e6 / kInternal_hz * (1.0 + clock_error_);
}

void Bmi088Model::Gyro::sample(Time now) {
  const GyroMode mode = gyro_mode(registers[0x10]);
  const auto every = static_cast<unsigned>(std::lround(kInternal_hz / mode.rate_hz));
  const ImuTruth truth = exposure_(now);
  const double range = 2000.0 / (1u << (registers[0x0F] & 7u)) * base::kRadPerDeg;
  const bool out = internal_++ % every == 0;
  for (std::size_t k = 0; k < 3; ++k) {
    filter_[k].configure(mode.bandwidth_hz, kInternal_hz);
    const double y = filter_[k].step(truth.gyro_rad_s[k]);
    if (out) put(registers, 0x02u + 2u * static_cast<unsigned>(k), counts(y, range));
  }
  if (!out) return;
  ++samples_;
  const bool mapped = (registers[0x15] & 0x80u) != 0 && (registers[0x18] & 0x01u) != 0 &&
                      (registers[0x16] & 0x03u) == 0x01u;
  if (!mapped || registers.faults.no_edges) return;
  line_falls_ = now + kLineHigh;
  if (line) line(true, now);
}

}  // namespace rosflight::boards::parts::models
