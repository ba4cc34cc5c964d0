// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/rules.hpp"

#include <array>
#include <cmath>

#include "sim/faults.hpp"

namespace rosflight::bench::faults {
namespace {

using sim::Fault;
using sim::FaultKind;

double duration_s(const Fault& fault) {
  return fault.end == sim::Time::max()
             ? 1e9
             : 1e-6 * static_cast<double>((fault.end - fault.start).count());
}

Rule rule_of(const Fault& fault, const Case& flown) {
  const bool fixed_wing = subjects()[flown.subject].fixed_wing;
  constexpr double kBridged_s = 0.3 + 1e-6;
  switch (fault.kind) {
    case FaultKind::kServo:
      // Surface 0 of the anaconda is its aileron, the others are the halves of the V-tail.
      return fault.motor > 0 ? Rule::kPitchSurface : Rule::kNone;
    case FaultKind::kMotor:
      return !fixed_wing && fault.factor == 0.0 ? Rule::kRotorDead : Rule::kNone;
    case FaultKind::kImu:
    case FaultKind::kImuNan:
    case FaultKind::kImuStuck:
      return duration_s(fault) > kBridged_s ? Rule::kImuGone : Rule::kNone;
    case FaultKind::kGyroStep:
      return std::abs(fault.value) > kGyroBiasLimit_rad_s ? Rule::kGyroBeyond : Rule::kNone;
    case FaultKind::kLinkCut:
      return !fixed_wing && flown.pilot == "idle" ? Rule::kPilotHasIt : Rule::kNone;
    default:
      return Rule::kNone;
  }
}

Fault parsed(const std::string& text) {
  return sim::parse_fault(at_time(text, 0.0));
}

}  // namespace

const char* name(Class c) {
  constexpr std::array<const char*, kClasses> kNames{"done",    "landed", "ground",
                                                     "timeout", "hard",   "crash"};
  return kNames.at(static_cast<std::size_t>(c));
}

const char* name(Rule rule) {
  constexpr std::array<const char*, kRules> kNames{"", "R1", "R2", "R3", "R4", "R5", "R6"};
  return kNames.at(static_cast<std::size_t>(rule));
}

const char* text(Rule rule) {
  constexpr std::array<const char*, kRules> kTexts{
      "",
      "A half of the V-tail is stuck: pitch cannot be held.",
      "One rotor of four is dead: three cannot hold the attitude.",
      "The IMU is silent, damaged or stuck for longer than 0.3 s.",
      "The gyro step is beyond the largest bias that the estimator learns, 0.1 rad/s.",
      "The link is cut, and the safety pilot of a multirotor holds his throttle stick at idle. The "
      "pilot has the vehicle then, as in ROSflight 2.x.",
      "The fault began before lift-off and the take-off was given up: the vehicle stands on the "
      "ground "
      "with its motors off. For `ground` only, and for nothing that happens in the air."};
  return kTexts.at(static_cast<std::size_t>(rule));
}

Rule rule_of(const Case& flown) {
  const Rule rule = rule_of(parsed(flown.first), flown);
  if (rule != Rule::kNone || flown.second.empty()) return rule;
  return rule_of(parsed(flown.second), flown);
}

bool before_lift_off(const std::string& phase) {
  return phase == "armed" || phase == "roll" || phase == kBeforeLiftOff;
}

Rule allowed_by(const Case& flown, Class ended) {
  switch (ended) {
    case Class::kNotFlown:
      return before_lift_off(flown.phase) ? Rule::kTakeOffGivenUp : Rule::kNone;
    case Class::kHardLanding:
    case Class::kCrash:
      return rule_of(flown);
    default:
      return Rule::kNone;
  }
}

bool needs_mission(const Case& flown) {
  if (!flown.second.empty() || flown.failsafe_command) return false;
  const bool fixed_wing = subjects()[flown.subject].fixed_wing;
  const bool hover = flown.pilot == "hover";
  const Fault fault = parsed(flown.first);
  const auto lasts = [&fault](double at_most_s) { return duration_s(fault) < at_most_s + 1e-6; };
  switch (fault.kind) {
    case FaultKind::kCrash:
    case FaultKind::kHang:
    case FaultKind::kMag:
    case FaultKind::kBaro:
    case FaultKind::kRange:
    case FaultKind::kBattery:
    case FaultKind::kPitotBlocked:
      return true;
    case FaultKind::kGnss:
      return lasts(20.0);
    case FaultKind::kLinkCut:
      return lasts(3.0) && (fixed_wing || hover);
    case FaultKind::kRcSilence:
      return lasts(10.0) && hover;
    case FaultKind::kRcFrameLoss:
      return lasts(2.0);
    case FaultKind::kCompanionStall:
      return lasts(1.0);
    case FaultKind::kLinkNoise:
      return fault.value <= 0.01;
    case FaultKind::kMotor:
      return fault.factor >= 0.8;
    default:
      return false;
  }
}

bool explained(const Case& flown, Class ended) {
  if (ended == Class::kMissionDone) return true;
  if (needs_mission(flown)) return false;
  return ended == Class::kLandedElsewhere || allowed_by(flown, ended) != Rule::kNone;
}

}  // namespace rosflight::bench::faults
