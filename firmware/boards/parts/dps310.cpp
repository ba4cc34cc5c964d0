// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/dps310.hpp"

#include <algorithm>

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kPressure = 0x00, kTemperature = 0x03;
constexpr std::uint8_t kPressureConf = 0x06, kEightTimes = 0x63;
constexpr std::uint8_t kTemperatureConf = 0x07, kOnce = 0x60;
constexpr std::uint8_t kMeasure = 0x08, kMeasurePressure = 0x01, kMeasureTemperature = 0x02;
constexpr std::uint8_t kCoefficientsReady = 0xC0;  // and the sensor
constexpr std::uint8_t kTemperatureReady = 0x20, kPressureReady = 0x10;
constexpr std::uint8_t kConf = 0x09, kThreeWires = 0x01;
constexpr std::uint8_t kReset = 0x0C, kSoftReset = 0x09;
constexpr std::uint8_t kProduct = 0x0D, kProductValue = 0x10;
constexpr std::uint8_t kCoefficients = 0x10;
constexpr std::uint8_t kCoefficientSource = 0x28, kExternal = 0x80;
constexpr std::uint8_t kRead = 0x80;

constexpr float kScaleOnce = 524288.0f;
constexpr float kScaleEightTimes = 7864320.0f;
constexpr Time kPressureTime{14'800};
constexpr Time kTemperatureTime{3'600};
constexpr std::uint8_t kLateTicks = 20;

}  // namespace

/// Three wires must be configured before anything is read, again after the reset. The writes
/// to 0x0E, 0x0F and 0x62 and the temperature measurement that follows make some parts measure the
/// right temperature.
std::array<SetupStep, Dps310::kSteps> Dps310::steps(bool three_wires) {
  using K = SetupKind;
  const std::uint8_t wires = three_wires ? kThreeWires : 0;
  return {{{K::kWrite, kReset, kSoftReset, 0xFF, 40'000},
           {K::kWrite, kConf, wires, 0xFF, 0, true},
           {K::kIdentity, kProduct, kProductValue},
           {K::kAwait, kMeasure, kCoefficientsReady, kCoefficientsReady, 40'000},
           {K::kConfigure, kConf, wires},
           {K::kWrite, 0x0E, 0xA5},
           {K::kWrite, 0x0F, 0x96},
           {K::kWrite, 0x62, 0x02},
           {K::kWrite, 0x0E, 0x00},
           {K::kWrite, 0x0F, 0x00},
           {K::kWrite, kMeasure, kMeasureTemperature, 0xFF, 10'000},
           {K::kConfigure, kPressureConf, kEightTimes},
           {K::kIdentity, kProduct, kProductValue}}};
}

Dps310::Dps310(Port& port, bool three_wires)
    : Driver{"DPS310"}, port_{port}, steps_{steps(three_wires)}, setup_{port, {kRead, 0}, steps_} {}

Dps310::Coefficients Dps310::unpack(const std::array<std::uint8_t, 18>& r) {
  // Twelve and twenty bits share a byte with their neighbour.
  const auto bits = [&r](unsigned first, unsigned count) {
    std::uint32_t value = 0;
    for (unsigned k = first; k < first + count; ++k)
      value = value << 1 | (unsigned{r[k / 8]} >> (7 - k % 8) & 1u);
    return sign_extend(value, count);
  };
  return {bits(0, 12),  bits(12, 12), bits(24, 20),  bits(44, 20), bits(64, 16),
          bits(80, 16), bits(96, 16), bits(112, 16), bits(128, 16)};
}

float Dps310::pressure_Pa(const Coefficients& c, float q, float t) {
  const auto f = [](std::int32_t value) { return static_cast<float>(value); };
  return f(c.c00) + q * (f(c.c10) + q * (f(c.c20) + q * f(c.c30))) + t * f(c.c01) +
         t * q * (f(c.c11) + q * f(c.c21));
}

float Dps310::temperature_K(const Coefficients& c, float t) {
  return kZeroCelsius_K + 0.5f * static_cast<float>(c.c0) + static_cast<float>(c.c1) * t;
}

bool Dps310::begin(Start how, Time now) {
  if (on_bus_) return false;
  stage_ = Stage::kSetup;
  have_temperature_ = false;
  return setup_.begin(how, now);
}

void Dps310::step_start(Time now) {
  if (stage_ != Stage::kSetup) {
    if (!on_bus_) advance_start(now);
    return;
  }
  if (!step_setup(setup_, now)) return;
  if (setup_.rewritten() > 0) {
    static_cast<void>(setup_.begin(Start::kCold, now));  // it lost its power, and its work-around
  } else {
    stage_ = Stage::kSource;
    advance_start(now);
  }
}

/// Starts the transfer of the stage.
void Dps310::advance_start(Time now) {
  if (stage_ == Stage::kSource) {
    read(Stage::kSource, kCoefficientSource, 1);
  } else if (stage_ == Stage::kCoefficients) {
    read(Stage::kCoefficients, kCoefficients, in_.size());
  } else if (stage_ == Stage::kConfigure) {
    write(Stage::kConfigure, kTemperatureConf, static_cast<std::uint8_t>(kOnce | source_));
  } else {
    started();
    pressure_ = false;
    due_ = std::max(now, begun() + kPressureTime);
  }
}

void Dps310::command(bool pressure) {
  pressure_ = pressure;
  late_ = 0;
  write(Stage::kCommand, kMeasure, pressure ? kMeasurePressure : kMeasureTemperature);
}

void Dps310::step_running(Time now) {
  if (on_bus_ || now < due_) return;
  if (stage_ == Stage::kMeasuring) {
    read(Stage::kStatus, kPressureConf, 3);
  } else {
    command(pressure_);  // the last one was lost
  }
}

void Dps310::read(Stage stage, std::uint8_t reg, std::size_t count) {
  stage_ = stage;
  out_[0] = static_cast<std::uint8_t>(reg | kRead);
  transfer_ = {out_.data(), 1, in_.data(), count, this};
  on_bus_ = port_.start(transfer_);
}

void Dps310::write(Stage stage, std::uint8_t reg, std::uint8_t value) {
  stage_ = stage;
  out_ = {reg, value};
  transfer_ = {out_.data(), 2, nullptr, 0, this};
  on_bus_ = port_.start(transfer_);
}

void Dps310::transfer_done(Transfer& /*transfer*/, TransferResult result, Time end) {
  on_bus_ = false;
  if (state() == PartState::kFailed) return;
  if (!good(result, end)) {
    // While starting, the same transfer is tried again; while running, the measurement.
    if (stage_ >= Stage::kCommand) stage_ = Stage::kCommand;
    return;
  }
  switch (stage_) {
    case Stage::kSource:
      source_ = in_[0] & kExternal;
      stage_ = Stage::kCoefficients;
      advance_start(end);
      break;
    case Stage::kCoefficients:
      c_ = unpack(in_);
      stage_ = Stage::kConfigure;
      advance_start(end);
      break;
    case Stage::kConfigure:
      stage_ = Stage::kCommand;
      advance_start(end);
      break;
    case Stage::kCommand:
      commanded_ = end;
      due_ = end + (pressure_ ? kPressureTime : kTemperatureTime);
      stage_ = Stage::kMeasuring;
      break;
    case Stage::kStatus:
      status_read(end);
      break;
    case Stage::kResult:
      result_read();
      break;
    case Stage::kSetup:
    case Stage::kMeasuring:
      break;
  }
}

/// The set-up is read with the status: a part that lost its power for a moment measures on demand as
/// before, but with other scale factors.
void Dps310::status_read(Time now) {
  const std::uint8_t status = in_[2];
  if (in_[0] != kEightTimes || in_[1] != (kOnce | source_)) {
    fail(now).add("set-up lost, register 0x06 is ").hex(in_[0]);
    return;
  }
  if ((status & (pressure_ ? kPressureReady : kTemperatureReady)) != 0) {
    read(Stage::kResult, pressure_ ? kPressure : kTemperature, 3);
    return;
  }
  stage_ = Stage::kMeasuring;
  if (++late_ >= kLateTicks) fail(now).add("no measurement, register 0x08 is ").hex(status);
}

void Dps310::result_read() {
  const auto raw = static_cast<float>(sign_extend(be24(in_.data()), 24));
  if (pressure_) {
    hal::BaroSample sample;
    sample.stamp = commanded_ + kPressureTime / 2;
    sample.pressure_Pa = pressure_Pa(c_, raw / kScaleEightTimes, t_);
    sample.temperature_K = temperature_K(c_, t_);
    if (have_temperature_) static_cast<void>(samples_.put(sample));
    well();
  } else {
    t_ = raw / kScaleOnce;
    have_temperature_ = true;
  }
  command(!pressure_);
}

}  // namespace rosflight::boards::parts
