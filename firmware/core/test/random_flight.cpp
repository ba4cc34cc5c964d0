// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/random_flight.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "firmware/core/mixer_frames.hpp"

namespace rosflight::core {
namespace {

constexpr std::array<const char*, kIngredientCount> kNames{
    "receiver_faults", "companion", "auxiliary",  "hostile",    "parameters",
    "foreign",         "garbage",   "commands",   "imu_faults", "other_sensors",
    "storage_faults",  "restarts",  "time_jumps", "motion",     "motor_tests"};
/// How often a flight has each of them.
constexpr std::array<float, kIngredientCount> kShare{
    0.35f, 0.6f, 0.4f, 0.2f, 0.3f, 0.4f, 0.15f, 0.2f, 0.25f, 0.7f, 0.1f, 0.3f, 0.1f, 0.1f, 0.25f};
constexpr std::size_t kRoll = 0, kPitch = 1, kThrottle = 2, kYaw = 3, kArmChannel = 5,
                      kOverrideChannel = 4;

template <class Value>
void set(Parameters& p, const char* name, Value value) {
  const auto id = static_cast<Param>(Parameters::find(padded_name(name)));
  if constexpr (std::is_integral_v<Value>) {
    static_cast<void>(p.set_int(id, value));
  } else {
    static_cast<void>(p.set_float(id, value));
  }
}

}  // namespace

const char* to_string(Ingredient ingredient) {
  return kNames[static_cast<std::size_t>(ingredient)];
}

RandomFlight::RandomFlight(std::uint64_t seed, Without without) : seed_{seed}, pilot_{seed} {
  pilot_ = Random{pilot_.next()};
  for (auto& r : randoms_) r = Random{pilot_.next()};
  choose_ingredients(without);
  constexpr std::array<Vehicle, 6> kVehicles{Vehicle::kQuadrotor, Vehicle::kQuadrotor,
                                             Vehicle::kQuadrotor, Vehicle::kCustomWithMotors,
                                             Vehicle::kFixedWing, Vehicle::kCustomWithMotors};
  vehicle_ = pilot_.pick(kVehicles);
  arm_switch_ = pilot_.chance(0.5f);
  calibrate_gyro_ = pilot_.chance(0.4f);
  take_min_throttle_ = !pilot_.chance(0.15f);
  constexpr std::array<std::int64_t, 5> kPasses_us{1000, 2000, 2500, 2500, 5000};
  pass_ = hal::microseconds(pilot_.pick(kPasses_us));
  if (pilot_.chance(0.3f)) jitter_ = hal::microseconds(400);
  imu_period_ = pilot_.chance(0.7f) ? pass_ : 2 * pass_;
  constexpr std::array<std::int64_t, 3> kFrames_us{20'000, 9'000, 2'000};
  rc_period_ = hal::microseconds(pilot_.pick(kFrames_us));
  Random choice{~seed};  // its own, so that the flights are what they were before there was one
  companion_in_failsafe_ = choice.chance(0.5f);
  hands_off_ = companion_in_failsafe_ && choice.chance(0.7f);
  companion_held_ = choice.chance(0.5f);
  enter(Phase::kRest, 100, 600);
}

void RandomFlight::choose_ingredients(Without without) {
  // One in ten is quiet, so that some flights go by the book.
  const bool quiet = pilot_.chance(0.1f);
  for (std::size_t k = 0; k < kIngredientCount; ++k) present_[k] = pilot_.chance(kShare[k]);
  const auto at = [this](Ingredient i) -> bool& { return present_[static_cast<std::size_t>(i)]; };
  // A message behind garbage may be lost for one firmware and not for its twin.
  if (at(Ingredient::kGarbage)) at(Ingredient::kForeign) = false;
  for (std::size_t k = 0; k < kIngredientCount; ++k) {
    if (quiet || without[k]) present_[k] = false;
  }
}

void RandomFlight::configure(Parameters& p) const {
  set(p, "ACC_Z_BIAS", 0.001f);
  set(p, "GYRO_X_BIAS", 1e-6f);
  set(p, "RC_NUM_CHN", std::int32_t{8});
  set(p, "TAKE_MIN_THR", std::int32_t{take_min_throttle_});
  set(p, "ARM_CAL_GYRO", std::int32_t{calibrate_gyro_});
  set(p, "FAILSAFE_OFFBRD", std::int32_t{companion_in_failsafe_});
  // The companion commands 0.2 at least: enough to fly with the smaller one.
  set(p, "FAILSAFE_THR", companion_held_ ? 0.15f : 0.3f);
  set(p, "OFFBOARD_HOLD", companion_held_ ? std::int32_t{300} : std::int32_t{0});
  if (arm_switch_) set(p, "RC_ARM_CHN", static_cast<std::int32_t>(kArmChannel));
  switch (vehicle_) {
    case Vehicle::kQuadrotor:
      set(p, "PRIMARY_MIXER", std::int32_t{2});
      break;
    case Vehicle::kFixedWing:
      set(p, "PRIMARY_MIXER", std::int32_t{9});
      set(p, "FIXED_WING", std::int32_t{1});
      set(p, "RC_F_AXIS", std::int32_t{0});
      break;
    case Vehicle::kCustomWithMotors: {
      set(p, "PRIMARY_MIXER", static_cast<std::int32_t>(MixerId::kCustom));
      set(p, "USE_MOTOR_PARAM", std::int32_t{1});
      constexpr float kSpeedSqPerNewton = 5100.0f;  // of a 0.38 m propeller, four of them
      const MixerGains gains = frame_gains(MixerId::kQuadX);
      for (std::size_t out = 0; out < 4; ++out) {
        set(p, ("PRI_MIXER_OUT_" + std::to_string(out)).c_str(), std::int32_t{2});
        for (std::size_t in = 0; in < 6; ++in) {
          const float gain = gains(static_cast<Eigen::Index>(out), static_cast<Eigen::Index>(in));
          const auto name = "PRI_MIXER_" + std::to_string(in) + "_" + std::to_string(out);
          set(p, name.c_str(), kSpeedSqPerNewton * gain);
        }
      }
      set(p, "PRI_MIXER_OUT_4", std::int32_t{1});
      set(p, "PRI_MIXER_6_4", 1.0f);
      set(p, "PRI_MIXER_OUT_7", std::int32_t{3});
      set(p, "PRI_MIXER_7_7", 1.0f);
      break;
    }
  }
}

std::string RandomFlight::description() const {
  constexpr std::array<const char*, 3> kVehicleNames{"quadrotor", "custom mixer with motors",
                                                     "fixed wing"};
  std::string text = kVehicleNames[static_cast<std::size_t>(vehicle_)];
  text += arm_switch_ ? ", arm switch" : ", sticks";
  if (calibrate_gyro_) text += ", ARM_CAL_GYRO";
  if (companion_in_failsafe_) text += ", FAILSAFE_OFFBRD";
  if (companion_held_) text += ", OFFBOARD_HOLD";
  text += ", pass " + std::to_string(pass_.count()) + " us, IMU " +
          std::to_string(imu_period_.count()) + " us, receiver " +
          std::to_string(rc_period_.count()) + " us; with";
  for (std::size_t k = 0; k < kIngredientCount; ++k) {
    if (present_[k]) text += std::string(" ") + kNames[k];
  }
  return text;
}

bool RandomFlight::happens(Ingredient i, Time mean) {
  return random(i).chance(static_cast<float>(pass_.count()) / static_cast<float>(mean.count()));
}

Time RandomFlight::soon(Random& random, std::int64_t min_ms, std::int64_t max_ms) const {
  return inputs_.now + hal::milliseconds(random.between(min_ms, max_ms));
}

const PassInputs& RandomFlight::next() {
  PassInputs& in = inputs_;
  in.now += pass_;
  if (jitter_ > Time{0}) in.now += hal::microseconds(pilot_.between(0, jitter_.count()));
  if (has(Ingredient::kTimeJumps) && happens(Ingredient::kTimeJumps, hal::milliseconds(4000))) {
    constexpr std::array<std::int64_t, 6> kJumps_ms{30, 120, 250, 600, 1200, 20'000};
    in.now += hal::milliseconds(random(Ingredient::kTimeJumps).pick(kJumps_ms));
  }
  in.imu.reset(), in.mag.reset(), in.baro.reset(), in.diff_pressure.reset();
  in.range.reset(), in.gnss.reset(), in.battery.reset(), in.rc.reset();
  in.packets.clear();
  advance_pilot();
  receiver();
  imu();
  other_sensors();
  if (has(Ingredient::kCompanion)) companion();
  if (has(Ingredient::kAuxiliary)) auxiliary();
  if (has(Ingredient::kParameters)) parameters();
  if (has(Ingredient::kHostile)) hostile();
  if (has(Ingredient::kCommands)) commands();
  if (has(Ingredient::kMotorTests)) motor_tests();
  if (has(Ingredient::kForeign)) foreign();
  if (has(Ingredient::kGarbage)) garbage();
  if (has(Ingredient::kStorageFaults)) storage();
  in.restart = Restart::kNone;
  if (has(Ingredient::kRestarts)) restarts();
  return in;
}

// ---- pilot

void RandomFlight::enter(Phase phase, std::int64_t min_ms, std::int64_t max_ms) {
  phase_ = phase;
  phase_end_ = soon(pilot_, min_ms, max_ms);
}

void RandomFlight::advance_pilot() {
  if (inputs_.now >= phase_end_) {
    throttle_slip_ = false;
    switch (phase_) {
      case Phase::kRest:
        enter(Phase::kAsk, 1050, 1400);
        if (arm_switch_) phase_end_ = soon(pilot_, 20, 300);
        throttle_slip_ = pilot_.chance(0.08f);
        break;
      case Phase::kAsk:
        enter(Phase::kWait, 50, 900);
        if (calibrate_gyro_) phase_end_ = soon(pilot_, 800, 3500);
        throttle_slip_ = pilot_.chance(0.1f);
        break;
      case Phase::kWait:
        enter(Phase::kFly, 500, 4000);
        if (pilot_.chance(0.1f)) enter(Phase::kDisarm, 1100, 1500);
        break;
      case Phase::kFly:
        enter(pilot_.chance(0.4f) && arm_switch_ ? Phase::kUpAgain : Phase::kLand, 100, 700);
        break;
      case Phase::kUpAgain:  // the switch was off for a moment in flight
        enter(Phase::kFly, 500, 2000);
        break;
      case Phase::kLand:
        enter(Phase::kDisarm, 1050, 1500);
        break;
      case Phase::kDisarm:
        enter(Phase::kRest, 50, 1200);
        break;
    }
    // Without minimum throttle the pilot must hold the override switch to arm.
    override_on_ = pilot_.chance(0.15f) || (!take_min_throttle_ && phase_ != Phase::kFly);
  }
  const auto wander = [this](float value, float low, float high) {
    return std::clamp(value + pilot_.uniform(-0.02f, 0.02f), low, high);
  };
  auto& s = sticks_;
  const bool flies = phase_ == Phase::kFly || phase_ == Phase::kUpAgain;
  if (flies) {
    for (const std::size_t k : {kRoll, kPitch, kYaw}) {
      const float moved = wander(s[k], 0.3f, 0.7f);
      s[k] = hands_off_ ? 0.5f : moved;
    }
    s[kThrottle] = s[kThrottle] < 0.2f ? 0.5f : wander(s[kThrottle], 0.2f, 0.95f);
  } else {
    s = {0.5f, 0.5f, throttle_slip_ ? 0.6f : 0.0f, 0.5f};
    if (phase_ == Phase::kAsk && !arm_switch_) s[kYaw] = 1.0f;
    if (phase_ == Phase::kDisarm && !arm_switch_) s[kYaw] = 0.0f;
  }
  switch_on_ = phase_ == Phase::kAsk || phase_ == Phase::kWait || phase_ == Phase::kFly ||
               phase_ == Phase::kLand;
  // Off for the first half of the second that rearming in the air takes.
  if (phase_ == Phase::kUpAgain) switch_on_ = phase_end_ - inputs_.now < hal::milliseconds(50);
}

void RandomFlight::receiver() {
  const bool due = inputs_.now >= next_rc_;
  if (has(Ingredient::kReceiverFaults)) {
    Random& r = random(Ingredient::kReceiverFaults);
    if (inputs_.now >= rc_fault_end_) rc_fault_ = RcFault::kNone;
    if (rc_fault_ == RcFault::kNone &&
        happens(Ingredient::kReceiverFaults, hal::milliseconds(2500))) {
      rc_fault_ = static_cast<RcFault>(1 + r.below(5));
      rc_fault_end_ = r.chance(0.5f) ? soon(r, 5, 150) : soon(r, 150, 1500);
      if (rc_fault_ == RcFault::kSwitchOff) rc_fault_end_ = soon(r, 1, 90);
    }
  }
  if (!due) return;
  next_rc_ = inputs_.now + rc_period_;
  if (rc_fault_ == RcFault::kSilent) return;
  hal::RcFrame frame;
  frame.stamp = inputs_.now;
  frame.channel_count = 8;
  for (std::size_t k = 0; k < sticks_.size(); ++k) frame.channels[k] = sticks_[k];
  frame.channels[kArmChannel] = switch_on_ ? 1.0f : 0.0f;
  frame.channels[kOverrideChannel] = override_on_ ? 1.0f : 0.0f;
  spoil_frame(frame);
  inputs_.rc = frame;
}

void RandomFlight::spoil_frame(hal::RcFrame& frame) {
  Random& r = random(Ingredient::kReceiverFaults);
  switch (rc_fault_) {
    case RcFault::kLostFlag:
      frame.frame_lost = true;
      break;
    case RcFault::kFailsafeFlag:
      frame.failsafe = frame.frame_lost = true;
      break;
    case RcFault::kAbsurd:
      frame.channels[r.below(8)] = hostile_value(r);
      break;
    case RcFault::kSwitchOff:
      frame.channels[kArmChannel] = 0.0f;
      break;
    case RcFault::kNone:
    case RcFault::kSilent:
      break;
  }
}

// ---- sensors

void RandomFlight::imu() {
  inputs_.imu_unusable = false;
  if (has(Ingredient::kImuFaults)) {
    Random& r = random(Ingredient::kImuFaults);
    if (inputs_.now >= imu_fault_end_) imu_fault_ = ImuFault::kNone;
    if (imu_fault_ == ImuFault::kNone && happens(Ingredient::kImuFaults, hal::milliseconds(3000))) {
      imu_fault_ = r.chance(0.3f) ? ImuFault::kSilent : static_cast<ImuFault>(1 + r.below(8));
      imu_fault_end_ = r.chance(0.5f) ? soon(r, 1, 90) : soon(r, 90, 1600);
      if (imu_fault_ == ImuFault::kSilent && r.chance(0.5f)) imu_fault_end_ = soon(r, 1050, 2000);
    }
  }
  if (has(Ingredient::kMotion) && happens(Ingredient::kMotion, hal::milliseconds(3000))) {
    turn_rad_s_ = random(Ingredient::kMotion).uniform(-1.5f, 1.5f);
    turn_end_ = soon(random(Ingredient::kMotion), 50, 1500);
  }
  if (inputs_.now < next_imu_) return;
  next_imu_ = inputs_.now + imu_period_ - hal::microseconds(10);
  if (imu_fault_ == ImuFault::kSilent) return;
  const bool flies = phase_ == Phase::kFly || phase_ == Phase::kUpAgain;
  const float shake = flies ? 0.3f : 0.004f;
  hal::ImuSample s;
  s.stamp = inputs_.now;
  for (float& w : s.gyro_rad_s) w = pilot_.uniform(-shake, shake);
  for (float& a : s.accel_m_s2) a = pilot_.uniform(-shake, shake);
  if (inputs_.now < turn_end_) s.gyro_rad_s[2] += turn_rad_s_;
  s.accel_m_s2[2] -= 9.80665f;
  s.temperature_K = 300.0f;
  const bool none = imu_fault_ == ImuFault::kNan || imu_fault_ == ImuFault::kIdentical ||
                    imu_fault_ == ImuFault::kStanding || imu_fault_ == ImuFault::kBackwards;
  inputs_.imu_unusable = none && imu_fault_ == last_imu_fault_;
  last_imu_fault_ = imu_fault_;
  spoil_imu(s);
  last_imu_ = s;
  inputs_.imu = s;
}

void RandomFlight::spoil_imu(hal::ImuSample& s) {
  Random& r = random(Ingredient::kImuFaults);
  switch (imu_fault_) {
    case ImuFault::kNan:
      (r.chance(0.5f) ? s.gyro_rad_s : s.accel_m_s2)[r.below(3)] =
          std::numeric_limits<float>::quiet_NaN();
      break;
    case ImuFault::kIdentical:
      s.gyro_rad_s = last_imu_.gyro_rad_s;
      s.accel_m_s2 = last_imu_.accel_m_s2;
      break;
    case ImuFault::kStanding:
      s.stamp = last_imu_.stamp;
      break;
    case ImuFault::kBackwards:
      s.stamp = last_imu_.stamp - hal::microseconds(500);
      break;
    case ImuFault::kAhead:  // one sample
      s.stamp += hal::milliseconds(r.between(1, 3000));
      imu_fault_ = ImuFault::kNone;
      break;
    case ImuFault::kOffset:
      s.stamp += hal::milliseconds(150);
      break;
    case ImuFault::kHuge:
      s.gyro_rad_s[r.below(3)] = hostile_value(r);
      s.accel_m_s2[r.below(3)] = hostile_value(r);
      break;
    case ImuFault::kNone:
    case ImuFault::kSilent:
      break;
  }
}

void RandomFlight::other_sensors() {
  PassInputs& in = inputs_;
  // The battery is always there: motor parameters need its voltage.
  Random& r = random(Ingredient::kOtherSensors);
  const bool all = has(Ingredient::kOtherSensors);
  const bool first = in.now < hal::milliseconds(20);
  if (first || happens(Ingredient::kOtherSensors, hal::milliseconds(100))) {
    in.battery = hal::BatterySample{in.now, 24.0f + r.uniform(-0.5f, 0.5f), 10.0f};
    if (all && !first && r.chance(0.02f)) in.battery->voltage_V = hostile_value(r);
  }
  if (!all) return;
  const auto bad = [&r] { return r.chance(0.01f); };
  if (happens(Ingredient::kOtherSensors, hal::milliseconds(20))) {
    in.baro = hal::BaroSample{in.now, 95'000.0f + r.uniform(-5.0f, 5.0f), 300.0f};
    if (bad()) in.baro->pressure_Pa = r.chance(0.5f) ? 1000.0f : hostile_value(r);
  }
  if (happens(Ingredient::kOtherSensors, hal::milliseconds(20))) {
    in.mag = hal::MagSample{in.now, {2e-5f, 1e-6f, 4e-5f}, 300.0f};
    if (bad()) in.mag->field_T[r.below(3)] = hostile_value(r);
  }
  if (happens(Ingredient::kOtherSensors, hal::milliseconds(20))) {
    in.diff_pressure = hal::DiffPressureSample{in.now, r.uniform(-3.0f, 3.0f), 300.0f};
    if (bad()) in.diff_pressure->pressure_Pa = hostile_value(r);
  }
  if (happens(Ingredient::kOtherSensors, hal::milliseconds(50))) {
    in.range = hal::RangeSample{in.now, 2.0f, 0.1f, 10.0f, hal::RangeKind::kLidar};
    if (bad()) in.range->range_m = hostile_value(r);
  }
  if (happens(Ingredient::kOtherSensors, hal::milliseconds(200))) {
    in.gnss.emplace();
    in.gnss->stamp = in.now;
    in.gnss->fix = hal::GnssFix::k3d;
    if (bad()) in.gnss->velocity_ned_m_s[r.below(3)] = hostile_value(r);
  }
}

// ---- board

void RandomFlight::storage() {
  Random& r = random(Ingredient::kStorageFaults);
  if (inputs_.now < storage_until_) return;
  storage_until_ = soon(r, 100, 3000);
  inputs_.storage =
      r.chance(0.5f) ? StorageFault::kNone : static_cast<StorageFault>(1 + r.below(4));
}

void RandomFlight::restarts() {
  if (!happens(Ingredient::kRestarts, hal::milliseconds(5000))) return;
  inputs_.restart =
      random(Ingredient::kRestarts).chance(0.75f) ? Restart::kFault : Restart::kPowerCut;
}

}  // namespace rosflight::core
