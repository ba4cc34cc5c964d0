// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::core {

enum class State : std::uint8_t {
  kInit,
  kPreflight,
  kArmed,
  kError,
  kFailsafe,
  kCalibrating,  ///< Arming was requested; the gyro calibration that it needs is running.
  kSaving,       ///< Arming was requested; changed parameters are being stored, a block per pass.
  kMotorTest,    ///< Disarmed, one motor turns, at most at 30 % of full output.
};
inline constexpr std::size_t kStateCount = 8;

enum class Event : std::uint8_t {
  kInitialized,
  kRcFound,
  kRcLost,
  kError,     ///< Some error bit is set.
  kNoError,   ///< No error bit is set.
  kArm,       ///< Arming is requested on the ground: every condition is tested.
  kArmInAir,  ///< The outputs must follow the command again at once.
  kDisarm,
  kCalibrationComplete,
  kCalibrationFailed,
  kSaved,
  kSaveFailed,
  kMotorTest,     ///< A motor test was requested.
  kMotorTestEnd,  ///< Its time is over, or another motor was requested.
};
inline constexpr std::size_t kEventCount = 14;

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

/// Actions of a transition besides the change of state, combined as bits.
using Actions = std::uint32_t;
namespace action {
inline constexpr Actions kNone = 0;
inline constexpr Actions kArm = 1 << 0;
inline constexpr Actions kDisarm = 1 << 1;
inline constexpr Actions kFailsafeOn = 1 << 2;
inline constexpr Actions kFailsafeOff = 1 << 3;
inline constexpr Actions kErrorOn = 1 << 4;
inline constexpr Actions kErrorOff = 1 << 5;
inline constexpr Actions kSetRcLost = 1 << 6;
inline constexpr Actions kClearRcLost = 1 << 7;
// Carried out by the owner:
inline constexpr Actions kCalibrateGyro = 1 << 8;
inline constexpr Actions kStopCalibration = 1 << 9;
inline constexpr Actions kSave = 1 << 10;           ///< Store the parameters.
inline constexpr Actions kRefuse = 1 << 11;         ///< Not armed: a check of the list refuses.
inline constexpr Actions kRefuseStorage = 1 << 12;  ///< Not armed: parameters not stored.
inline constexpr Actions kStopMotorTest = 1 << 13;
inline constexpr Actions kSendStatus = 1 << 14;  ///< State or error word changed.
inline constexpr Actions kInAir = 1 << 15;       ///< With kArm: armed in the air.
}  // namespace action

/// Condition of a row of the table; the first row whose condition holds is taken.
enum class Condition : std::uint8_t {
  kAlways,
  kNotReady,           ///< A check of the list before arming refuses.
  kCalibrationWanted,  ///< ARM_CAL_GYRO.
  kSaveWanted,         ///< Parameters have changed since they were stored.
  kErrorFlag,
  kCannotFly,  ///< No mixer, no IMU or no receiver.
};

struct Transition {
  State state;
  Event event;
  Condition condition;
  Actions actions;
  State next;
};

/// The complete safety logic. Combinations that are not listed change nothing. tools/state_diagram.py
/// draws the diagram in docs/ from these rows. A disarm request does not end a motor test, because an
/// arm switch that is off sends one with every frame.
// clang-format off
inline constexpr std::array<Transition, 45> kTransitions{{
    {State::kInit,        Event::kInitialized,         Condition::kAlways,             action::kNone, State::kPreflight},

    {State::kPreflight,   Event::kRcFound,             Condition::kAlways,             action::kClearRcLost | action::kFailsafeOff, State::kPreflight},
    {State::kPreflight,   Event::kRcLost,              Condition::kAlways,             action::kSetRcLost, State::kPreflight},
    {State::kPreflight,   Event::kError,               Condition::kAlways,             action::kErrorOn, State::kError},
    {State::kPreflight,   Event::kArm,                 Condition::kNotReady,           action::kRefuse, State::kPreflight},
    {State::kPreflight,   Event::kArm,                 Condition::kCalibrationWanted,  action::kCalibrateGyro, State::kCalibrating},
    {State::kPreflight,   Event::kArm,                 Condition::kSaveWanted,         action::kSave, State::kSaving},
    {State::kPreflight,   Event::kArm,                 Condition::kAlways,             action::kArm, State::kArmed},
    {State::kPreflight,   Event::kArmInAir,            Condition::kAlways,             action::kArm | action::kInAir, State::kArmed},
    {State::kPreflight,   Event::kDisarm,              Condition::kAlways,             action::kNone, State::kPreflight},
    {State::kPreflight,   Event::kMotorTest,           Condition::kAlways,             action::kNone, State::kMotorTest},

    {State::kError,       Event::kRcFound,             Condition::kAlways,             action::kClearRcLost | action::kFailsafeOff, State::kError},
    {State::kError,       Event::kRcLost,              Condition::kAlways,             action::kSetRcLost, State::kError},
    {State::kError,       Event::kNoError,             Condition::kAlways,             action::kErrorOff, State::kPreflight},
    {State::kError,       Event::kArm,                 Condition::kAlways,             action::kRefuse, State::kError},
    {State::kError,       Event::kArmInAir,            Condition::kCannotFly,          action::kRefuse, State::kError},
    {State::kError,       Event::kArmInAir,            Condition::kAlways,             action::kArm | action::kInAir, State::kArmed},
    {State::kError,       Event::kDisarm,              Condition::kAlways,             action::kNone, State::kError},

    {State::kCalibrating, Event::kCalibrationComplete, Condition::kNotReady,           action::kRefuse, State::kPreflight},
    {State::kCalibrating, Event::kCalibrationComplete, Condition::kSaveWanted,         action::kSave, State::kSaving},
    {State::kCalibrating, Event::kCalibrationComplete, Condition::kAlways,             action::kArm, State::kArmed},
    {State::kCalibrating, Event::kCalibrationFailed,   Condition::kAlways,             action::kNone, State::kPreflight},
    {State::kCalibrating, Event::kDisarm,              Condition::kAlways,             action::kStopCalibration, State::kPreflight},
    {State::kCalibrating, Event::kRcLost,              Condition::kAlways,             action::kSetRcLost, State::kCalibrating},
    {State::kCalibrating, Event::kError,               Condition::kAlways,             action::kErrorOn | action::kStopCalibration, State::kError},

    {State::kSaving,      Event::kSaved,               Condition::kNotReady,           action::kRefuse, State::kPreflight},
    {State::kSaving,      Event::kSaved,               Condition::kSaveWanted,         action::kSave, State::kSaving},
    {State::kSaving,      Event::kSaved,               Condition::kAlways,             action::kArm, State::kArmed},
    {State::kSaving,      Event::kSaveFailed,          Condition::kAlways,             action::kRefuseStorage, State::kPreflight},
    {State::kSaving,      Event::kDisarm,              Condition::kAlways,             action::kNone, State::kPreflight},
    {State::kSaving,      Event::kRcLost,              Condition::kAlways,             action::kSetRcLost, State::kSaving},
    {State::kSaving,      Event::kError,               Condition::kAlways,             action::kErrorOn, State::kError},

    {State::kArmed,       Event::kRcLost,              Condition::kAlways,             action::kFailsafeOn | action::kSetRcLost, State::kFailsafe},
    {State::kArmed,       Event::kDisarm,              Condition::kErrorFlag,          action::kDisarm, State::kError},
    {State::kArmed,       Event::kDisarm,              Condition::kAlways,             action::kDisarm, State::kPreflight},
    {State::kArmed,       Event::kError,               Condition::kAlways,             action::kErrorOn, State::kArmed},
    {State::kArmed,       Event::kNoError,             Condition::kAlways,             action::kErrorOff, State::kArmed},

    {State::kFailsafe,    Event::kRcFound,             Condition::kAlways,             action::kFailsafeOff | action::kClearRcLost, State::kArmed},
    {State::kFailsafe,    Event::kDisarm,              Condition::kAlways,             action::kDisarm, State::kError},
    {State::kFailsafe,    Event::kError,               Condition::kAlways,             action::kErrorOn, State::kFailsafe},

    {State::kMotorTest,   Event::kMotorTestEnd,        Condition::kAlways,             action::kStopMotorTest, State::kPreflight},
    {State::kMotorTest,   Event::kArm,                 Condition::kAlways,             action::kStopMotorTest, State::kPreflight},
    {State::kMotorTest,   Event::kDisarm,              Condition::kAlways,             action::kNone, State::kMotorTest},
    {State::kMotorTest,   Event::kRcLost,              Condition::kAlways,             action::kSetRcLost, State::kMotorTest},
    {State::kMotorTest,   Event::kError,               Condition::kAlways,             action::kErrorOn | action::kStopMotorTest, State::kError},
}};
// clang-format on

/// Inputs of the decision about a request to arm on the ground; evaluated again at the end of each
/// step of arming.
struct ArmRequest {
  bool ready{true};            ///< No check of the list refuses (arming_checks.hpp).
  bool calibrate_gyro{false};  ///< ARM_CAL_GYRO.
  bool save{false};            ///< Parameters differ from those stored.
};

/// Evaluates the table above and holds the three flags and the error word. Setting an error bit
/// raises kError; clearing one raises kError or kNoError, depending on the remaining bits.
class StateMachine {
 public:
  /// Applies the first row that holds. @returns the actions for the owner: all from kCalibrateGyro on,
  /// and kArm or kDisarm if it happened.
  Actions handle(Event event, const ArmRequest& request = {});
  /// Sets a bit of the error word. @returns as handle().
  Actions set_error(Error error);
  /// Clears a bit of the error word. @returns as handle().
  Actions clear_error(Error error);
  /// Once per pass: brings the state into agreement with the error word. @returns as handle().
  Actions update() {
    // The flag follows the word in every state that the table reaches, so equal means nothing to do.
    if ((errors_ != 0) == error_) return action::kNone;
    return handle(errors_ != 0 ? Event::kError : Event::kNoError);
  }

  State state() const { return state_; }
  bool armed() const { return armed_; }
  bool failsafe() const { return failsafe_; }
  bool error() const { return error_; }
  std::uint16_t errors() const { return errors_; }
  /// The bit is set in the error word.
  bool has(Error error) const { return (errors_ & static_cast<std::uint16_t>(error)) != 0; }
  /// Armed, or in a step of arming, so that a disarm request has an effect.
  bool arming() const {
    return armed_ || state_ == State::kCalibrating || state_ == State::kSaving;
  }

 private:
  Actions apply(const Transition& row);
  bool holds(Condition condition, const ArmRequest& request) const;

  State state_{State::kInit};
  bool armed_{false};
  bool failsafe_{false};
  bool error_{false};
  std::uint16_t errors_{0};
};

}  // namespace rosflight::core
