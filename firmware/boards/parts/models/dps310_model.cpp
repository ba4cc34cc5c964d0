// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/models/dps310_model.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::boards::parts::models {
namespace {

// Coefficients of the order of those of a real part.
constexpr int kC0 = 204, kC1 = -264;
constexpr int kC00 = 80'469, kC10 = -54'857, kC01 = -2'864, kC11 = 1'213;
constexpr int kC20 = -9'973, kC21 = -123, kC30 = -1'402;

constexpr std::array<double, 8> kScale{524288, 1572864, 3670016, 7864320,
                                       253952, 516096,  1040384, 2088960};
constexpr std::array<double, 8> kTime_ms{3.6, 5.2, 8.4, 14.8, 27.6, 53.2, 104.4, 206.8};

double scale_of(std::uint8_t conf) {
  return kScale[conf & 7u];
}
Time time_of(std::uint8_t conf) {
  return Time{std::lround(1000.0 * kTime_ms[conf & 7u])};
}

double pressure(double q, double t) {
  return kC00 + q * (kC10 + q * (kC20 + q * kC30)) + t * kC01 + t * q * (kC11 + q * kC21);
}

double q_of(double pressure_Pa, double t) {
  double low = -2.0;
  double high = 2.0;  // pressure falls with q
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (pressure(middle, t) > pressure_Pa ? low : high) = middle;
  }
  return low;
}

}  // namespace

Dps310Model::Dps310Model(Exposure exposure, bool three_wires)
    : exposure_{std::move(exposure)}, three_wires_{three_wires} {
  reset();
}

void Dps310Model::reset() {
  registers.clear();
  registers[0x0D] = 0x10;
  registers[0x28] = 0x80;
  unsigned at = 0;
  const auto put = [&](int value, unsigned bits) {
    for (unsigned k = bits; k-- > 0; ++at) {
      const auto reg = static_cast<std::uint8_t>(0x10 + at / 8);
      const unsigned bit = (static_cast<unsigned>(value) >> k & 1u) << (7 - at % 8);
      registers[reg] = static_cast<std::uint8_t>(registers[reg] | bit);
    }
  };
  put(kC0, 12);
  put(kC1, 12);
  put(kC00, 20);
  put(kC10, 20);
  for (const int c : {kC01, kC11, kC20, kC21, kC30}) put(c, 16);
  reset_at_ = now_;
  done_ = kNever;
  worked_around_ = false;
  unlocking_ = 0;
}

void Dps310Model::set_power(bool on) {
  powered_ = on;
  if (on) reset();
}

std::uint8_t Dps310Model::read_register(std::uint8_t reg) {
  const Time up = now_ - reset_at_;
  if (up < hal::milliseconds(3)) return 0xFF;
  if (three_wires_ != ((registers[0x09] & 1u) != 0)) return 0xFF;
  if (reg == 0x08) {
    const unsigned coefficients = up >= hal::milliseconds(40) ? 0x80u : 0u;
    const unsigned sensor = up >= hal::milliseconds(12) ? 0x40u : 0u;
    return static_cast<std::uint8_t>(registers[reg] | coefficients | sensor);
  }
  if (reg == 0x00) registers[0x08] = static_cast<std::uint8_t>(registers[0x08] & ~0x10u);
  if (reg == 0x03) registers[0x08] = static_cast<std::uint8_t>(registers[0x08] & ~0x20u);
  if (reg >= 0x10 && reg <= 0x21 && up < hal::milliseconds(40)) return 0;
  return registers[reg];
}

void Dps310Model::write_register(std::uint8_t reg, std::uint8_t value) {
  constexpr std::array<std::pair<int, int>, 5> kWorkAround{
      {{0x0E, 0xA5}, {0x0F, 0x96}, {0x62, 0x02}, {0x0E, 0x00}, {0x0F, 0x00}}};
  if (reg == 0x0C) {
    if ((value & 0x0Fu) == 0x09) reset();
    return;
  }
  if (now_ - reset_at_ < hal::milliseconds(3)) complain("written during start-up");
  if (reg == 0x06 || reg == 0x07 || reg == 0x09) {
    registers[reg] = value;
  } else if (reg == 0x08) {
    registers[reg] = static_cast<std::uint8_t>((registers[reg] & 0x30u) | (value & 7u));
    measure();
  } else if (unlocking_ < 5 && kWorkAround[unlocking_] == std::pair<int, int>{reg, value}) {
    worked_around_ = ++unlocking_ == 5;
  }
}

/// Starts what register 0x08 asks for.
void Dps310Model::measure() {
  const unsigned mode = registers[0x08] & 7u;
  if (mode == 0) done_ = kNever;
  if (mode == 0 || mode == 4) return;
  if (done_ != kNever) complain("commanded during a measurement");
  kind_ = mode == 3 || mode == 7 ? 1 : mode & 3u;
  begun_ = now_;
  done_ = stalls ? kNever : now_ + time_of(registers[kind_ == 1 ? 0x06 : 0x07]);
  if (kind_ == 1 && (registers[0x06] & 0x0Fu) > 3 && (registers[0x09] & 0x04u) == 0) {
    complain("pressure shift missing above 8 times");
  }
}

void Dps310Model::advance(Time now) {
  while (done_ <= now) {
    now_ = done_;
    finish();
  }
  now_ = now;
}

void Dps310Model::finish() {
  const Time middle = begun_ + (done_ - begun_) / 2;
  const BaroTruth truth = exposure_(middle);
  const double wrong_K = needs_work_around && !worked_around_ ? 60.0 : 0.0;
  const double t = (truth.temperature_K - 273.15 - 0.5 * kC0) / kC1;
  const double t_read = (truth.temperature_K + wrong_K - 273.15 - 0.5 * kC0) / kC1;
  const bool source_matches = (registers[0x07] & 0x80u) == (registers[0x28] & 0x80u);
  if (kind_ == 1) {
    put24(0x00, q_of(truth.pressure_Pa, t) * scale_of(registers[0x06]));
  } else {
    put24(0x03, (source_matches ? t_read : 0.9 * t_read) * scale_of(registers[0x07]));
  }
  const unsigned mode = registers[0x08] & 7u;
  registers[0x08] = static_cast<std::uint8_t>(registers[0x08] | (kind_ == 1 ? 0x10u : 0x20u));
  done_ = kNever;
  if (mode < 5) {
    registers[0x08] = static_cast<std::uint8_t>(registers[0x08] & ~7u);
    return;
  }
  if (mode == 7) kind_ = 3 - kind_;
  begun_ = now_;
  done_ = now_ + time_of(registers[kind_ == 1 ? 0x06 : 0x07]);
}

void Dps310Model::put24(std::uint8_t reg, double raw) {
  const auto value =
      static_cast<std::uint32_t>(std::clamp(std::lround(raw), -8388608l, 8388607l) & 0xFFFFFF);
  for (unsigned k = 0; k < 3; ++k) {
    registers[static_cast<std::uint8_t>(reg + k)] =
        static_cast<std::uint8_t>(value >> (16 - 8 * k) & 0xFFu);
  }
}

}  // namespace rosflight::boards::parts::models
