// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::core {

enum class State : std::uint8_t { kInit, kPreflight, kArmed, kError, kFailsafe, kCalibrating };
inline constexpr std::size_t kStateCount = 6;

enum class Event : std::uint8_t {
  kInitialized,
  kRcFound,
  kRcLost,
  kError,    ///< Some error bit is set.
  kNoError,  ///< No error bit is set.
  kArm,
  kDisarm,
  kCalibrationComplete,
  kCalibrationFailed,
};
inline constexpr std::size_t kEventCount = 9;

/// Bits of the error word, as in the status message.
enum class Error : std::uint16_t {
  kInvalidMixer = 0x01,
  kImuNotResponding = 0x02,
  kRcLost = 0x04,
  kUnhealthyEstimator = 0x08,
  kTimeGoingBackwards = 0x10,
  kUncalibratedImu = 0x20,
  kBufferOverrun = 0x40,
  kInvalidFailsafe = 0x80,
};

/// What a transition does besides changing the state. Combined as bits.
namespace action {
inline constexpr std::uint16_t kNone = 0;
inline constexpr std::uint16_t kArm = 1 << 0;
inline constexpr std::uint16_t kDisarm = 1 << 1;
inline constexpr std::uint16_t kFailsafeOn = 1 << 2;
inline constexpr std::uint16_t kFailsafeOff = 1 << 3;
inline constexpr std::uint16_t kErrorOn = 1 << 4;
inline constexpr std::uint16_t kErrorOff = 1 << 5;
inline constexpr std::uint16_t kSetRcLost = 1 << 6;
inline constexpr std::uint16_t kClearRcLost = 1 << 7;
// To be carried out by the owner:
inline constexpr std::uint16_t kCalibrateGyro = 1 << 8;
inline constexpr std::uint16_t kRefuseThrottle = 1 << 9;   ///< Not armed: throttle stick not low.
inline constexpr std::uint16_t kRefuseOverride = 1 << 10;  ///< Not armed: throttle override is off.
inline constexpr std::uint16_t kRefuseErrors = 1 << 11;    ///< Not armed: error word not empty.
inline constexpr std::uint16_t kSendStatus = 1 << 12;      ///< State or error word changed.
}  // namespace action

/// What must hold for a row of the table; the first row that holds is taken.
enum class Condition : std::uint8_t {
  kAlways,
  kThrottleHigh,
  kOverrideOff,
  kCalibrationWanted,
  kErrorFlag,
};

struct Transition {
  State state;
  Event event;
  Condition condition;
  std::uint16_t actions;
  State next;
};

/// The safety logic, whole. Combinations that are not listed change nothing. tools/state_diagram.py
/// draws the picture in docs/ from these rows.
// clang-format off
inline constexpr std::array<Transition, 25> kTransitions{{
    {State::kInit,        Event::kInitialized,         Condition::kAlways,            action::kNone,          State::kPreflight},

    {State::kPreflight,   Event::kRcFound,             Condition::kAlways,            action::kClearRcLost | action::kFailsafeOff, State::kPreflight},
    {State::kPreflight,   Event::kRcLost,              Condition::kAlways,            action::kSetRcLost,     State::kPreflight},
    {State::kPreflight,   Event::kError,               Condition::kAlways,            action::kErrorOn,       State::kError},
    {State::kPreflight,   Event::kArm,                 Condition::kThrottleHigh,      action::kRefuseThrottle, State::kPreflight},
    {State::kPreflight,   Event::kArm,                 Condition::kOverrideOff,       action::kRefuseOverride, State::kPreflight},
    {State::kPreflight,   Event::kArm,                 Condition::kCalibrationWanted, action::kCalibrateGyro, State::kCalibrating},
    {State::kPreflight,   Event::kArm,                 Condition::kAlways,            action::kArm,           State::kArmed},

    {State::kError,       Event::kRcFound,             Condition::kAlways,            action::kClearRcLost | action::kFailsafeOff, State::kError},
    {State::kError,       Event::kRcLost,              Condition::kAlways,            action::kSetRcLost,     State::kError},
    {State::kError,       Event::kNoError,             Condition::kAlways,            action::kErrorOff,      State::kPreflight},
    {State::kError,       Event::kArm,                 Condition::kAlways,            action::kRefuseErrors,  State::kError},

    {State::kCalibrating, Event::kCalibrationComplete, Condition::kAlways,            action::kArm,           State::kArmed},
    {State::kCalibrating, Event::kCalibrationFailed,   Condition::kAlways,            action::kNone,          State::kPreflight},
    {State::kCalibrating, Event::kRcLost,              Condition::kAlways,            action::kSetRcLost,     State::kCalibrating},
    {State::kCalibrating, Event::kError,               Condition::kAlways,            action::kErrorOn,       State::kError},
    {State::kCalibrating, Event::kNoError,             Condition::kAlways,            action::kErrorOff,      State::kCalibrating},

    {State::kArmed,       Event::kRcLost,              Condition::kAlways,            action::kFailsafeOn | action::kSetRcLost, State::kFailsafe},
    {State::kArmed,       Event::kDisarm,              Condition::kErrorFlag,         action::kDisarm,        State::kError},
    {State::kArmed,       Event::kDisarm,              Condition::kAlways,            action::kDisarm,        State::kPreflight},
    {State::kArmed,       Event::kError,               Condition::kAlways,            action::kErrorOn,       State::kArmed},
    {State::kArmed,       Event::kNoError,             Condition::kAlways,            action::kErrorOff,      State::kArmed},

    {State::kFailsafe,    Event::kRcFound,             Condition::kAlways,            action::kFailsafeOff | action::kClearRcLost, State::kArmed},
    {State::kFailsafe,    Event::kDisarm,              Condition::kAlways,            action::kDisarm,        State::kError},
    {State::kFailsafe,    Event::kError,               Condition::kAlways,            action::kErrorOn,       State::kFailsafe},
}};
// clang-format on

/// What the pilot's controls say when he asks to arm.
struct ArmRequest {
  bool throttle_low{true};
  bool override_ok{true};      ///< TAKE_MIN_THR is set, or the throttle override switch is on.
  bool calibrate_gyro{false};  ///< ARM_CAL_GYRO.
};

/// Arms, disarms, and remembers what is wrong: the table above, the three flags and the error word.
/// Setting an error bit raises kError; clearing one raises kError or kNoError by what is left.
class StateMachine {
 public:
  /// @returns the actions left to the owner (kCalibrateGyro, kRefuse..., kSendStatus, and kArm or
  /// kDisarm if it happened).
  std::uint16_t handle(Event event, const ArmRequest& request = {});
  std::uint16_t set_error(Error error);
  std::uint16_t clear_error(Error error);
  /// Once per pass: lets the state follow the error word.
  std::uint16_t update();

  State state() const { return state_; }
  bool armed() const { return armed_; }
  bool failsafe() const { return failsafe_; }
  bool error() const { return error_; }
  std::uint16_t errors() const { return errors_; }
  bool has(Error error) const { return (errors_ & static_cast<std::uint16_t>(error)) != 0; }

 private:
  std::uint16_t apply(const Transition& row);
  bool holds(Condition condition, const ArmRequest& request) const;

  State state_{State::kInit};
  bool armed_{false};
  bool failsafe_{false};
  bool error_{false};
  std::uint16_t errors_{0};
};

}  // namespace rosflight::core
