// SPDX-License-Identifier: BSD-3-Clause
#include "sim/faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/constants.hpp"
#include "config/strict_yaml.hpp"
#include "sim/types.hpp"

namespace rosflight::sim {
namespace {
constexpr double kMaxDuration_s = 1e9;

struct Name {
  std::string_view name;
  FaultKind kind;
  std::string_view effect;
};

constexpr std::array<Name, 18> kNames{{
    {"imu", FaultKind::kImu, "the IMU stops delivering"},
    {"mag", FaultKind::kMag, "the magnetometer stops delivering"},
    {"baro", FaultKind::kBaro, "the barometer stops delivering"},
    {"gnss", FaultKind::kGnss, "the satellite receiver stops delivering"},
    {"diff_pressure", FaultKind::kDiffPressure, "the pitot tube stops delivering"},
    {"range", FaultKind::kRange, "the sonar or lidar stops delivering"},
    {"battery", FaultKind::kBattery, "the battery monitor stops delivering"},
    {"imu_nan", FaultKind::kImuNan, "IMU samples turn into NaN"},
    {"imu_stuck", FaultKind::kImuStuck, "IMU samples repeat the last good values"},
    {"rc_silence", FaultKind::kRcSilence, "the receiver sends nothing"},
    {"rc_frame_loss", FaultKind::kRcFrameLoss, "receiver frames carry the frame-lost flag"},
    {"link_cut", FaultKind::kLinkCut, "no byte passes the link, either way"},
    {"crash", FaultKind::kCrash, "the firmware crashes once and restarts"},
    {"hang", FaultKind::kHang, "the firmware hangs once, until the watchdog restarts it"},
    {"pitot_blocked", FaultKind::kPitotBlocked, "the pitot tube reads no pressure"},
    {"companion_stall", FaultKind::kCompanionStall, "the companion's program pauses"},
    {"battery_low", FaultKind::kBatteryLow, "the battery has 15 % of its charge left"},
    {"motion_capture", FaultKind::kMotionCapture, "no pose of motion capture arrives"},
}};

/// A fault with a size: NAME=VALUE. `unit` turns what is typed into what Fault holds.
struct Step {
  std::string_view name;
  FaultKind kind;
  std::size_t axis;
  double largest;  ///< As typed; either sign, unless the kind has_sign() of its own.
  double unit;
  std::string_view effect;
};

using base::kRadPerDeg;
constexpr std::array<Step, 11> kSteps{{
    {"baro_step", FaultKind::kBaroStep, 0, 1000.0, 1.0,
     "VALUE metres are added to the height of the barometer"},
    {"mag_turned", FaultKind::kMagTurned, 0, 180.0, kRadPerDeg,
     "the magnetometer is turned by VALUE degrees about body z"},
    {"accel_step_x", FaultKind::kAccelStep, 0, 100.0, 1.0,
     "VALUE m/s^2 are added to this axis of the accelerometer"},
    {"accel_step_y", FaultKind::kAccelStep, 1, 100.0, 1.0, "the same"},
    {"accel_step_z", FaultKind::kAccelStep, 2, 100.0, 1.0, "the same"},
    {"gyro_step_x", FaultKind::kGyroStep, 0, 10.0, 1.0,
     "VALUE rad/s are added to this axis of the gyro"},
    {"gyro_step_y", FaultKind::kGyroStep, 1, 10.0, 1.0, "the same"},
    {"gyro_step_z", FaultKind::kGyroStep, 2, 10.0, 1.0, "the same"},
    {"gnss_step", FaultKind::kGnssStep, 0, 10000.0, 1.0,
     "the satellite position jumps VALUE metres to the north"},
    {"gnss_delay", FaultKind::kGnssDelay, 0, 10.0, 1.0, "fixes arrive VALUE seconds later"},
    {"link_noise", FaultKind::kLinkNoise, 0, 1.0, 1.0,
     "the share VALUE of the link's bytes is damaged"},
}};

/// Sizes below 0 have a meaning.
bool has_sign(FaultKind kind) {
  return kind != FaultKind::kGnssDelay && kind != FaultKind::kLinkNoise;
}

config::Error fault_error(std::string_view text, const std::string& found,
                          const std::string& allowed) {
  return config::Error("--fault " + std::string(text.substr(0, 60)) + ": found " + found +
                       ", allowed " + allowed);
}

std::string quoted(std::string_view text) {
  return text.empty() ? "nothing" : "\"" + std::string(text.substr(0, 60)) + "\"";
}

std::string all_names() {
  std::string out;
  for (const Name& entry : kNames) out += std::string(entry.name) + ", ";
  for (const Step& entry : kSteps) out += std::string(entry.name) + "=VALUE, ";
  return out + "servoN_stuck, motorN_dead, motorN_partial=FACTOR (or motorN=FACTOR), N from 0 to " +
         std::to_string(kMaxRotors - 1);
}

Time parse_seconds(std::string_view text, std::string_view part, const char* what, bool zero_too) {
  const auto seconds = config::parse_number(part);
  const bool good =
      seconds && *seconds <= kMaxDuration_s && (zero_too ? *seconds >= 0.0 : *seconds > 0.0);
  if (!good) {
    throw fault_error(text, std::string(what) + " " + quoted(part),
                      zero_too ? "seconds >= 0" : "seconds > 0");
  }
  return Time{std::llround(*seconds * 1e6)};
}

/// What follows "motor2" or "servo2"; the number goes to `index`.
std::optional<std::string_view> behind(std::string_view part, std::string_view what,
                                       std::size_t& index) {
  if (what.substr(0, part.size()) != part) return {};
  std::string_view rest = what.substr(part.size());
  if (rest.empty() || rest.front() < '0' || rest.front() > '9') return {};
  index = static_cast<std::size_t>(rest.front() - '0');
  static_assert(kMaxRotors == 10, "one digit names every motor");
  rest.remove_prefix(1);
  return rest;
}

/// "servo1_stuck".
bool parse_servo(std::string_view what, Fault& fault) {
  fault.kind = FaultKind::kServo;
  return behind("servo", what, fault.motor) == "_stuck";
}

/// "motor2_dead", "motor2_partial=0.6", "motor2=0.6".
bool parse_motor(std::string_view text, std::string_view what, Fault& fault) {
  const auto found = behind("motor", what, fault.motor);
  if (!found) return false;
  const std::string_view rest = *found;
  fault.kind = FaultKind::kMotor;
  if (rest == "_dead") {
    fault.factor = 0.0;
    return true;
  }
  const auto equals = rest.find('=');
  const std::string_view word = rest.substr(0, equals);
  if (equals == std::string_view::npos || (!word.empty() && word != "_partial")) return false;
  const std::string_view number = rest.substr(equals + 1);
  const auto factor = config::parse_number(number);
  if (!factor || *factor < 0.0 || *factor > 1.0) {
    throw fault_error(text, "the factor " + quoted(number), "a number from 0 to 1");
  }
  fault.factor = *factor;
  return true;
}
/// "baro_step=5".
bool parse_step(std::string_view text, std::string_view what, Fault& fault) {
  const auto equals = what.find('=');
  const std::string_view name = what.substr(0, equals);
  const auto* const known = std::find_if(kSteps.begin(), kSteps.end(),
                                         [name](const Step& entry) { return entry.name == name; });
  if (known == kSteps.end()) return false;
  const std::string_view number =
      equals == std::string_view::npos ? std::string_view{} : what.substr(equals + 1);
  const auto value = config::parse_number(number);
  const bool sign = has_sign(known->kind);
  if (!value || !(std::abs(*value) <= known->largest) || (!sign && *value < 0.0)) {
    throw fault_error(text, "the value " + quoted(number),
                      std::string(name) + "=VALUE with " + (sign ? "at most " : "0 to ") +
                          config::number_text(known->largest) + (sign ? " either way" : ""));
  }
  fault.kind = known->kind;
  fault.axis = known->axis;
  fault.value = *value * known->unit;
  return true;
}
}  // namespace

Fault parse_fault(std::string_view text) {
  Fault fault;
  const auto at = text.find('@');
  const std::string_view what = text.substr(0, at);
  const auto* const known = std::find_if(kNames.begin(), kNames.end(),
                                         [what](const Name& entry) { return entry.name == what; });
  if (known != kNames.end()) {
    fault.kind = known->kind;
  } else if (!parse_step(text, what, fault) && !parse_servo(what, fault) &&
             !parse_motor(text, what, fault)) {
    throw fault_error(text, quoted(what), all_names());
  }
  if (at == std::string_view::npos) throw fault_error(text, "no time", "WHAT@TIME[:DURATION]");
  const std::string_view times = text.substr(at + 1);
  const auto colon = times.find(':');
  fault.start = parse_seconds(text, times.substr(0, colon), "the time", true);
  if (colon != std::string_view::npos) {
    fault.end = fault.start + parse_seconds(text, times.substr(colon + 1), "the duration", false);
  }
  return fault;
}

std::string fault_help() {
  const auto line = [](std::string_view name, std::string_view effect) {
    constexpr std::size_t kColumn = 26;  // longer than every name
    std::string out = "  " + std::string(name);
    out.resize(kColumn, ' ');
    return out + std::string(effect) + "\n";
  };
  std::string out;
  for (const Name& entry : kNames) out += line(entry.name, entry.effect);
  for (const Step& entry : kSteps) out += line(std::string(entry.name) + "=VALUE", entry.effect);
  out += line("servoN_stuck", "control surface N (from 0) keeps its deflection");
  out += line("motorN_partial=FACTOR", "motor N (from 0) gives FACTOR (0 to 1) of its thrust");
  out += line("motorN_dead", "motor N gives none");
  return out;
}

FaultSchedule::FaultSchedule(std::vector<Fault> faults) : faults_{std::move(faults)} {
  for (const Fault& fault : faults_) kinds_ |= bit(fault.kind);
}

void FaultSchedule::add(const Fault& fault) {
  faults_.push_back(fault);
  kinds_ |= bit(fault.kind);
}

void FaultSchedule::end_all(Time t) {
  for (Fault& fault : faults_) fault.end = std::min(fault.end, std::max(fault.start, t));
}

FaultSchedule parse_faults(const std::vector<std::string>& texts) {
  std::vector<Fault> faults;
  faults.reserve(texts.size());
  for (const std::string& text : texts) faults.push_back(parse_fault(text));
  return FaultSchedule(std::move(faults));
}

bool FaultSchedule::active_now(FaultKind kind, Time t) const {
  return std::any_of(faults_.begin(), faults_.end(), [kind, t](const Fault& fault) {
    return fault.kind == kind && t >= fault.start && t < fault.end;
  });
}

double FaultSchedule::value_now(FaultKind kind, Time t, std::size_t axis) const {
  double sum = 0.0;
  for (const Fault& fault : faults_) {
    if (fault.kind == kind && fault.axis == axis && t >= fault.start && t < fault.end) {
      sum += fault.value;
    }
  }
  return sum;
}

bool FaultSchedule::servo_stuck(std::size_t surface, Time t) const {
  return has(FaultKind::kServo) &&
         std::any_of(faults_.begin(), faults_.end(), [surface, t](const Fault& fault) {
           return fault.kind == FaultKind::kServo && fault.motor == surface && t >= fault.start &&
                  t < fault.end;
         });
}

double FaultSchedule::thrust_factor(std::size_t motor, Time t) const {
  double factor = 1.0;
  if ((kinds_ & bit(FaultKind::kMotor)) == 0U) return factor;
  for (const Fault& fault : faults_) {
    if (fault.kind == FaultKind::kMotor && fault.motor == motor && t >= fault.start &&
        t < fault.end) {
      factor *= fault.factor;
    }
  }
  return factor;
}

}  // namespace rosflight::sim
