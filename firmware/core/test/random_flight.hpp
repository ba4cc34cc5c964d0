// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <bitset>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/log.hpp"
#include "firmware/core/parameters.hpp"
#include "firmware/core/test/random.hpp"
#include "firmware/hal/samples.hpp"
#include "link/messages.hpp"

namespace rosflight::core {

/// What a random flight is made of besides a pilot and an IMU. Each has a stream of random numbers
/// of its own, so that leaving one out changes nothing of the others: that is how a failure is
/// reduced to what it needs.
enum class Ingredient : std::uint8_t {
  kReceiverFaults,  ///< Loss and failsafe flags, silence, absurd channels, switch glitches.
  kCompanion,       ///< Heartbeat, time synchronization, offboard commands with pauses.
  kAuxiliary,       ///< Auxiliary commands with pauses.
  kHostile,         ///< Every kind of message with absurd values.
  kParameters,      ///< Parameter changes, reads, lists and storms of them.
  kForeign,         ///< Messages for another system. Excludes kGarbage.
  kGarbage,         ///< Bytes that are no message.
  kCommands,        ///< Calibrations, storage, defaults, reboot.
  kImuFaults,       ///< NaN, gaps, identical samples, stamps that jump, stand or run backwards.
  kOtherSensors,    ///< Magnetometer, pressures, range, GNSS, battery, with faults.
  kStorageFaults,   ///< Reads and writes that fail or take 8 ms.
  kRestarts,        ///< Faults with a crash record, power cuts.
  kTimeJumps,       ///< The clock jumps ahead.
  kMotion,          ///< The vehicle moves on the ground.
  kMotorTests,      ///< Motor tests by the book and not; requests for reports.
};
inline constexpr std::size_t kIngredientCount = 15;
const char* to_string(Ingredient ingredient);

enum class Vehicle : std::uint8_t { kQuadrotor, kCustomWithMotors, kFixedWing };

enum class StorageFault : std::uint8_t { kNone, kFailedWrites, kFailedReads, kFailed, kSlow };
enum class Restart : std::uint8_t { kNone, kFault, kPowerCut };

/// One message or some bytes for the firmware.
struct Packet {
  link::Message message;
  bool foreign{false};
  std::uint8_t garbage_size{0};  ///< Not 0: these bytes instead of a message.
  std::array<std::uint8_t, 64> garbage{};
};

/// Everything that happens to the firmware before and in one pass.
struct PassInputs {
  Time now{};
  std::optional<hal::ImuSample> imu;
  std::optional<hal::MagSample> mag;
  std::optional<hal::BaroSample> baro;
  std::optional<hal::DiffPressureSample> diff_pressure;
  std::optional<hal::RangeSample> range;
  std::optional<hal::GnssSample> gnss;
  std::optional<hal::BatterySample> battery;
  std::optional<hal::RcFrame> rc;
  std::vector<Packet> packets;
  StorageFault storage{StorageFault::kNone};
  Restart restart{Restart::kNone};
  bool imu_unusable{false};  ///< `imu` is none: not a number, repeated, or of no new time.
};

/// Makes a flight from a seed: a pilot arms, flies and disarms, and the disturbances of `Ingredient` come
/// on top, each of which can be left out. Open loop: the inputs do not depend on the firmware.
class RandomFlight {
 public:
  using Without = std::bitset<kIngredientCount>;

  /// Auxiliary commands drive motors on these outputs and servos on those, never otherwise.
  static constexpr std::array<std::size_t, 3> kAuxMotors{5, 8, 13};
  static constexpr std::array<std::size_t, 3> kAuxServos{6, 9, 12};

  explicit RandomFlight(std::uint64_t seed, Without without = {});

  /// Sets up the vehicle: mixer, receiver, calibration.
  void configure(Parameters& parameters) const;
  const PassInputs& next();

  std::uint64_t seed() const { return seed_; }
  Vehicle vehicle() const { return vehicle_; }
  bool has(Ingredient i) const { return present_[static_cast<std::size_t>(i)]; }
  std::string description() const;

 private:
  enum class Phase : std::uint8_t { kRest, kAsk, kWait, kFly, kLand, kDisarm, kUpAgain };

  Random& random(Ingredient i) { return randoms_[static_cast<std::size_t>(i)]; }
  /// Once per `mean` on average.
  bool happens(Ingredient i, Time mean);
  Time soon(Random& random, std::int64_t min_ms, std::int64_t max_ms) const;

  void choose_ingredients(Without without);
  void enter(Phase phase, std::int64_t min_ms, std::int64_t max_ms);
  void advance_pilot();
  void receiver();
  void spoil_frame(hal::RcFrame& frame);
  void imu();
  void spoil_imu(hal::ImuSample& sample);
  void other_sensors();
  void companion();
  void auxiliary();
  void parameters();
  void hostile();
  void foreign();
  void garbage();
  void commands();
  void motor_tests();
  void storage();
  void restarts();
  void put(const link::Message& message, bool foreign = false);
  link::Message parameter_message(Random& random, bool sane);
  link::Message hostile_message(Random& random);
  float hostile_value(Random& random);

  std::uint64_t seed_;
  Random pilot_;
  std::array<Random, kIngredientCount> randoms_;
  std::array<bool, kIngredientCount> present_{};
  Vehicle vehicle_{};
  bool arm_switch_{false};
  bool calibrate_gyro_{false};
  bool take_min_throttle_{true};
  bool companion_in_failsafe_{false};
  bool companion_held_{false};  ///< OFFBOARD_HOLD.
  bool hands_off_{false};       ///< Sticks centred in flight: the axes are the companion's.
  Time pass_{};
  Time jitter_{};
  Time imu_period_{};
  Time rc_period_{};

  PassInputs inputs_;
  Phase phase_{Phase::kRest};
  Time phase_end_{};
  Time next_rc_{}, next_imu_{};
  std::array<float, 4> sticks_{0.5f, 0.5f, 0.0f, 0.5f};
  bool switch_on_{false};
  bool override_on_{false};
  bool throttle_slip_{false};  ///< The stick is raised while the arming is under way.

  enum class RcFault : std::uint8_t {
    kNone,
    kSilent,
    kLostFlag,
    kFailsafeFlag,
    kAbsurd,
    kSwitchOff
  };
  RcFault rc_fault_{RcFault::kNone};
  Time rc_fault_end_{};
  enum class ImuFault : std::uint8_t {
    kNone,
    kSilent,
    kNan,
    kIdentical,
    kStanding,
    kBackwards,
    kAhead,
    kOffset,
    kHuge
  };
  ImuFault imu_fault_{ImuFault::kNone}, last_imu_fault_{ImuFault::kNone};
  Time imu_fault_end_{};
  hal::ImuSample last_imu_{};
  float turn_rad_s_{0.0f};
  Time turn_end_{};
  bool companion_on_{true};
  bool offboard_on_{false};
  Time companion_until_{}, offboard_until_{}, next_beat_{}, next_sync_{}, next_offboard_{};
  Time offboard_period_{};
  link::OffboardControl offboard_{};
  bool auxiliary_on_{false};
  Time auxiliary_until_{}, next_auxiliary_{};
  int storm_{0};
  Time storage_until_{};
  link::MotorTest motor_test_{};
  Time motor_test_until_{}, next_motor_test_{};
};

}  // namespace rosflight::core
