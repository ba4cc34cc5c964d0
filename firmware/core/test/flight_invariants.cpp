// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/flight_invariants.hpp"

#include <algorithm>
#include <sstream>

namespace rosflight::core {
namespace {

constexpr int kMaxMessages = 8;
constexpr std::size_t kMaxBytesRead = 1024 + 128;  // the last of what is read may wait
constexpr std::size_t kMaxBytesEncoded = 1024;
// Documented times and limits stand here as numbers: a check that takes them from the firmware
// would follow a slip in it.
constexpr Time kImuSilence = hal::milliseconds(100);
constexpr Time kImuHold = hal::milliseconds(300);
constexpr Time kGlide = hal::milliseconds(30'000);
constexpr Time kReceiverSilence = hal::milliseconds(200);
constexpr Time kBadFrames = hal::milliseconds(100);
constexpr Time kMotorTestTime = hal::milliseconds(300);
constexpr float kMotorTestLimit = 0.3f;
constexpr Time kHoldIdle = hal::milliseconds(500);
constexpr Time kInAir = hal::milliseconds(1000);
constexpr Time kLiftOff = hal::milliseconds(1000);
constexpr Time kCompanionSilence = hal::milliseconds(1000);
constexpr int kStuck = 20;
constexpr Time kImuLatch = hal::milliseconds(1000);
constexpr int kPassesPerScan = 64;

template <class... Words>
std::string words(const Words&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Flags and state that the table's rows carry from one to the next.
struct Situation {
  State state;
  bool armed;
  bool failsafe;
};
constexpr std::size_t kSituations = kStateCount * 4;
std::size_t index_of(const Situation& s) {
  return static_cast<std::size_t>(s.state) * 4 + (s.armed ? 2u : 0u) + (s.failsafe ? 1u : 0u);
}

/// What can be reached from where by the rows of the table, in at most the rows of one pass.
std::array<std::bitset<kSituations>, kSituations> reachable() {
  constexpr int kRowsPerPass = 4;
  std::array<std::bitset<kSituations>, kSituations> reach;
  for (std::size_t k = 0; k < kSituations; ++k) reach[k].set(k);
  for (int step = 0; step < kRowsPerPass; ++step) {
    for (auto& from : reach) {
      const auto now = from;
      for (std::size_t k = 0; k < kSituations; ++k) {
        if (!now[k]) continue;
        const Situation s{static_cast<State>(k / 4), (k & 2u) != 0, (k & 1u) != 0};
        for (const Transition& row : kTransitions) {
          if (row.state != s.state) continue;
          Situation next{row.next, s.armed, s.failsafe};
          if ((row.actions & action::kArm) != 0) next.armed = true;
          if ((row.actions & action::kDisarm) != 0) next.armed = false;
          if ((row.actions & action::kFailsafeOn) != 0) next.failsafe = true;
          if ((row.actions & action::kFailsafeOff) != 0) next.failsafe = false;
          from.set(index_of(next));
        }
      }
    }
  }
  return reach;
}

bool channels_valid(const hal::RcFrame& frame) {
  return std::all_of(frame.channels.begin(), frame.channels.begin() + 8,
                     [](float c) { return c >= -0.25f && c <= 1.25f; });
}

template <class Array>
bool same_bits(const Array& a, const Array& b) {
  return std::memcmp(a.data(), b.data(), sizeof(a)) == 0;
}

}  // namespace

FlightInvariants::FlightInvariants(const RandomFlight& flight)
    : seed_{flight.seed()}, has_foreign_{flight.has(Ingredient::kForeign)} {}

void FlightInvariants::fail(const char* invariant, const std::string& detail) {
  for (const Violation& known : violations_) {
    if (known.invariant == invariant) return;
  }
  violations_.push_back({invariant, detail, seed_, static_cast<int>(coverage_.passes) - 1});
}

bool FlightInvariants::check(const PassInputs& in, const WatchedFirmware& watched,
                             const WatchedFirmware& twin) {
  take_note(in, watched);
  check_state(watched);
  check_arming(watched);
  check_motors(watched);
  check_idle_after_arming(watched);
  check_motor_test(watched);
  check_imu(watched);
  check_receiver(watched);
  check_companion(watched);
  check_command(watched);
  check_disarming(watched);
  check_work(watched);
  check_twin(watched, twin);
  check_parameters(watched);
  note_state(watched);
  return !differs_;
}

// ---- what the checks need to know

void FlightInvariants::take_note(const PassInputs& in, const WatchedFirmware& watched) {
  now_ = watched.now();
  const Firmware& f = watched.firmware();
  if (watched.restarted()) note_restart(in, watched);
  if (in.imu) {
    imu_any_ = now_;
    if (in.imu_unusable && ++unusable_ == kStuck) stuck_at_ = now_;
    // What a slow storage takes moves the stamps of later samples.
    if (!in.imu_unusable || in.storage == StorageFault::kSlow) unusable_ = 0;
  }
  rc_bad_now_ = rc_failsafe_now_ = false;
  if (in.rc) note_frame(*in.rc, f);
  const PassWork& w = watched.work();
  if (w.received_companion) companion_ = now_;
  if (w.received_offboard) offboard_ = now_;
  if (armed_before_ && (w.received_offboard || w.received_auxiliary)) commanded_ = true;
  if (w.received_parameters) parameters_changed_ = now_;
  if (w.received_motor_test) motor_test_ = now_;
  count(in, watched);
}

void FlightInvariants::note_frame(const hal::RcFrame& frame, const Firmware& f) {
  const Parameters& p = f.parameters();
  rc_any_ = now_;
  rc_bad_now_ = frame.frame_lost || frame.failsafe;
  rc_failsafe_now_ = frame.failsafe;
  if (rc_bad_now_) return;
  rc_not_bad_ = now_;
  if (!channels_valid(frame)) {
    in_corner_ = false;
    off_frames_ = 0;
    return;
  }
  const auto channel = [&](Param id) {
    return frame.channels[static_cast<std::size_t>(p.get_int(id))];
  };
  constexpr Time kConsecutive = hal::milliseconds(60);
  const bool consecutive = now_ - rc_good_ <= kConsecutive;
  rc_good_ = now_;
  const float threshold = p.get_float(Param::kRcArmThreshold);
  throttle_before_ = throttle_;
  throttle_ = channel(Param::kRcFChn);
  const float yaw = 2.0f * (channel(Param::kRcZChn) - 0.5f);
  const bool low = throttle_ < threshold;
  if (!low) stick_raised_ = true;
  const std::int32_t arm_channel = p.get_int(Param::kRcArmChn);
  const bool by_switch = arm_channel >= 4 && arm_channel < p.get_int(Param::kRcNumChn);
  const bool corner = !by_switch && low && yaw < -(1.0f - threshold);
  if (corner && !(in_corner_ && consecutive)) corner_since_ = now_;
  in_corner_ = corner;
  bool off = false;
  if (by_switch) {
    const bool straight = p.get_int(Param::kSwitch5Dir) > 0 && p.get_int(Param::kSwitch6Dir) > 0 &&
                          p.get_int(Param::kSwitch7Dir) > 0 && p.get_int(Param::kSwitch8Dir) > 0;
    const float value = channel(Param::kRcArmChn);
    off = straight && value < 0.2f;
    if (!straight || value >= 0.8f) asked_ = true;
  } else if (low && yaw > 1.0f - threshold) {
    asked_ = true;
  }
  if (!off || !consecutive) off_frames_ = 0;
  if (off && off_frames_++ == 0) off_since_ = now_;
}

void FlightInvariants::note_restart(const PassInputs& in, const WatchedFirmware& watched) {
  ++coverage_.restarts;
  if (in.restart == Restart::kPowerCut) rearmed_.fill(kNever);  // nobody remembers
  const bool armed = watched.firmware().state().armed();
  if (armed) {
    ++coverage_.armed_after_fault;
    if (in.restart != Restart::kFault) fail("rearm_after_fault", "armed without a crash record");
    if (!armed_before_) fail("rearm_after_fault", "armed, but was not before the fault");
    const bool glides = watched.firmware().mixer().config().fixed_wing && now_ <= glides_until_;
    if (!above_idle_ && !glides) fail("rearm_after_fault", "armed, but no motor was above idle");
    glides_until_ = now_ + kGlide;
    if (now_ - rearmed_[0] < hal::milliseconds(60'000)) {
      fail("rearm_after_fault", "armed for the fourth time in 60 s");
    }
    rearmed_ = {rearmed_[1], rearmed_[2], now_};
  }
  on_ground_ = false;
  armed_at_ = armed ? now_ : kNever;
  disarmed_at_ = offboard_ = companion_ = motor_test_ = kNever;
  imu_any_ = rc_any_ = rc_not_bad_ = now_;
  rc_good_ = kNever;
  unusable_ = off_frames_ = 0;
  servo_once_ = 0;
  asked_ = imu_latched_ = in_corner_ = values_known_ = false;
  armed_before_ = armed;
}

void FlightInvariants::note_state(const WatchedFirmware& watched) {
  const Firmware& f = watched.firmware();
  const bool armed = f.state().armed();
  const float idle = f.mixer().config().idle_throttle;
  bool above = false, above_in_pass = above_idle_;
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    if (!is_motor(f, k)) continue;
    above = above || watched.outputs()[k] > idle + 1e-5f;
    above_in_pass = above_in_pass || watched.peak_outputs()[k] > idle + 1e-5f;
  }
  if (armed_before_ && !armed) {
    ++coverage_.disarmed;
    disarmed_at_ = now_;
    above_idle_at_disarm_ = above_in_pass;
    asked_ = imu_latched_ = false;
  }
  above_idle_ = above;
  if (armed && above) glides_until_ = now_ + kGlide;
  before_ = f.state().state();
  armed_before_ = armed;
  failsafe_before_ = f.state().failsafe();
}

void FlightInvariants::count(const PassInputs& in, const WatchedFirmware& watched) {
  const StateMachine& s = watched.firmware().state();
  const PassWork& w = watched.work();
  Coverage& c = coverage_;
  ++c.passes;
  ++c.in_state[static_cast<std::size_t>(s.state())];
  if (!watched.restarted()) {
    ++c.transitions[static_cast<std::size_t>(before_)][static_cast<std::size_t>(s.state())];
  }
  if (s.armed()) ++c.armed_passes;
  if (s.state() == State::kFailsafe) ++c.failsafe_passes;
  const bool goes_on = s.failsafe() && !watched.firmware().command().in_failsafe();
  if (goes_on) ++c.companion_in_failsafe_passes;
  if (s.armed() && watched.firmware().command().offboard_active()) ++c.offboard_passes;
  if (s.armed() && s.has(Error::kImuNotResponding)) ++c.imu_lost_armed;
  if (s.armed() && !failsafe_before_ && s.failsafe()) ++c.receiver_lost_armed;
  if (before_ == State::kCalibrating && s.state() != State::kCalibrating) ++c.calibrations_left;
  if (w.storage_writes > 0) ++c.saves;
  if (w.received_parameters) ++c.parameter_changes;
  for (const Packet& packet : in.packets) c.foreign_messages += packet.foreign ? 1u : 0u;
  for (const std::size_t k : RandomFlight::kAuxMotors) {
    if (s.armed() && watched.outputs()[k] > 0.2f) {
      ++c.auxiliary_motor_passes;
      break;
    }
  }
  c.longest_messages =
      std::max<std::uint64_t>(c.longest_messages, static_cast<std::uint64_t>(w.messages_decoded));
  c.longest_bytes_encoded = std::max<std::uint64_t>(c.longest_bytes_encoded, w.bytes_encoded);
  c.longest_bytes_read = std::max<std::uint64_t>(c.longest_bytes_read, w.bytes_read);
  const auto& text = watched.codec().last_text;
  if (text && std::strncmp(text->text.data(), "Unable to arm", 13) == 0) {
    ++c.refusals[text->text.data()];
  }
}

bool FlightInvariants::is_motor(const Firmware& f, std::size_t channel) const {
  if (channel < kChannels && f.mixer().header().type[channel] != OutputType::kAux) {
    return f.mixer().header().type[channel] == OutputType::kMotor;
  }
  // A free output that was a servo rests at its centre.
  if ((static_cast<unsigned>(servo_once_) >> channel & 1u) != 0) return false;
  const auto& motors = RandomFlight::kAuxMotors;
  return std::find(motors.begin(), motors.end(), channel) != motors.end();
}

// ---- outputs

void FlightInvariants::check_motors(const WatchedFirmware& watched) {
  const Firmware& f = watched.firmware();
  for (std::size_t k = 0; k < kChannels; ++k) {
    const OutputType type = f.mixer().header().type[k];
    if (type == OutputType::kServo || type == OutputType::kGpio) {
      servo_once_ = static_cast<std::uint16_t>(servo_once_ | 1u << k);
    }
  }
  if (watched.work().output_out_of_range) {
    fail("outputs_in_range", "an output is not a number of 0..1");
  }
  if (f.state().armed() || f.state().state() == State::kMotorTest) return;
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    if (is_motor(f, k) && watched.outputs()[k] != 0.0f) {
      fail("disarmed_motors_zero", words("motor ", k, " at ", watched.outputs()[k],
                                         armed_before_ ? " in the pass of disarming" : ""));
    }
  }
}

void FlightInvariants::check_idle_after_arming(const WatchedFirmware& watched) {
  const Firmware& f = watched.firmware();
  if (!f.state().armed() || !on_ground_ || stick_raised_ || commanded_) return;
  if (now_ - armed_at_ >= kHoldIdle) return;
  const float idle = f.mixer().config().idle_throttle;
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    if (is_motor(f, k) && watched.outputs()[k] > idle + 1e-5f) {
      fail("idle_after_arming", words("motor ", k, " at ", watched.outputs()[k], ", idle is ", idle,
                                      ", ", hal::to_ms(now_ - armed_at_), " ms after arming"));
    }
  }
}

void FlightInvariants::check_motor_test(const WatchedFirmware& watched) {
  const Firmware& f = watched.firmware();
  if (f.state().state() != State::kMotorTest) return;
  if (before_ != State::kMotorTest) {
    ++coverage_.motor_tests;
    if (!watched.work().received_motor_test) fail("motor_test_asked", "nobody asked for it");
  }
  if (now_ - motor_test_ > kMotorTestTime) {
    fail("motor_test_ends", words(hal::to_ms(now_ - motor_test_), " ms after the last message"));
  }
  int turning = 0;
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    if (!is_motor(f, k) || watched.outputs()[k] == 0.0f) continue;
    ++turning;
    if (!(watched.outputs()[k] <= kMotorTestLimit)) {
      fail("motor_test_limit", words("motor ", k, " at ", watched.outputs()[k]));
    }
  }
  if (turning > 1) fail("motor_test_one", words(turning, " motors turn"));
}

// ---- silence

void FlightInvariants::check_imu(const WatchedFirmware& watched) {
  const Firmware& f = watched.firmware();
  const bool silent = now_ - imu_any_ > kImuSilence;
  // A stuck IMU is known after twenty samples; from then on it is a silent one.
  const bool unusable = unusable_ >= kStuck && now_ - stuck_at_ > kImuSilence;
  if (f.state().armed() && now_ - imu_any_ > kImuLatch + hal::milliseconds(10)) imu_latched_ = true;
  const bool multirotor = !f.parameters().get_bool(Param::kFixedWing);
  if ((silent || unusable) && !f.state().has(Error::kImuNotResponding)) {
    fail(silent ? "imu_silence" : "imu_unusable",
         words("no error bit, last sample ", hal::to_ms(now_ - imu_any_), " ms ago, ", unusable_,
               " unusable in a row"));
  }
  const Time hold = f.state().armed() ? kImuHold : kImuSilence;
  const bool stands = now_ - imu_any_ > hold || (unusable_ >= kStuck && now_ - stuck_at_ > hold);
  if (!multirotor || !(stands || (imu_latched_ && f.state().armed()))) return;
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    if (!is_motor(f, k) || watched.outputs()[k] == 0.0f) continue;
    fail(silent     ? "imu_silence"
         : unusable ? "imu_unusable"
                    : "imu_latch",
         words("motor ", k, " at ", watched.outputs()[k], ", last sample ",
               hal::to_ms(now_ - imu_any_), " ms ago, ", unusable_, " unusable in a row"));
  }
}

void FlightInvariants::check_receiver(const WatchedFirmware& watched) {
  const StateMachine& s = watched.firmware().state();
  const CommandManager& c = watched.firmware().command();
  const bool companion =
      watched.firmware().parameters().get_bool(Param::kFailsafeOffbrd) && c.override_word() == 0;
  if (s.failsafe() && c.in_failsafe() == companion && parameters_changed_ != now_) {
    fail("failsafe_command",
         words("failsafe command ", c.in_failsafe(), ", override word ", c.override_word()));
  }
  const bool silent = now_ - rc_any_ > kReceiverSilence;
  const bool bad = rc_bad_now_ && now_ - rc_not_bad_ >= kBadFrames;
  if (!silent && !bad && !rc_failsafe_now_) return;
  if (s.armed() ? s.failsafe() : s.has(Error::kRcLost)) return;
  fail(silent ? "receiver_silence"
       : bad  ? "receiver_bad_frames"
              : "receiver_failsafe_flag",
       words(s.armed() ? "armed and no failsafe" : "no error bit", ", last frame ",
             hal::to_ms(now_ - rc_any_), " ms ago, last good one ", hal::to_ms(now_ - rc_not_bad_),
             " ms"));
}

void FlightInvariants::check_companion(const WatchedFirmware& watched) {
  const Firmware& f = watched.firmware();
  const CommandManager& c = f.command();
  const Parameters& p = f.parameters();
  const auto timeout = hal::milliseconds(p.get_int(Param::kOffboardTimeout));
  const auto hold =
      hal::milliseconds(p.get_bool(Param::kFixedWing) ? 0 : p.get_int(Param::kOffboardHold));
  const bool late = now_ - offboard_ > timeout && parameters_changed_ != now_;
  for (std::size_t k = 3; k < kAxes && late; ++k) {
    const bool pilot = k < 6 && (static_cast<unsigned>(c.primary_axes()) >> k & 1u) != 0;
    if (pilot || c.in_failsafe() || c.combined().value[k] == 0.0f) continue;
    fail(k < 6 ? "offboard_level" : "offboard_timeout",
         words("axis ", k, " still at ", c.combined().value[k]));
  }
  const bool holds = late && c.offboard_active();
  if (holds) ++coverage_.hold_passes;
  if (holds && now_ - offboard_ > timeout + hold) fail("offboard_timeout", "still active");
  const bool just_armed = on_ground_ && now_ - armed_at_ < kLiftOff;
  if (holds && (!f.state().armed() || f.state().failsafe() || just_armed)) {
    fail("offboard_hold_in_flight", words("armed ", f.state().armed(), ", just ", just_armed,
                                          ", failsafe ", f.state().failsafe()));
  }
  // Outputs follow when they are written next; without an IMU the motors stop for another reason.
  const bool silent = now_ - companion_ > kCompanionSilence;
  const bool over = silent || c.in_failsafe();
  if (!over) auxiliary_over_writes_ = 0;
  if (over && watched.work().outputs_written > 0) ++auxiliary_over_writes_;
  constexpr int kNextWrite = 2;
  if (auxiliary_over_writes_ < kNextWrite) return;
  for (const std::size_t k : RandomFlight::kAuxMotors) {
    const bool free = k >= kChannels || f.mixer().header().type[k] == OutputType::kAux;
    if (free && is_motor(f, k) && watched.outputs()[k] > f.mixer().config().idle_throttle + 1e-5f) {
      fail(silent ? "companion_silence" : "failsafe_auxiliary_motors",
           words("auxiliary motor ", k, " at ", watched.outputs()[k]));
    }
  }
}

// ---- commands

void FlightInvariants::check_command(const WatchedFirmware& watched) {
  const Firmware& f = watched.firmware();
  const CommandManager& c = f.command();
  if (!c.offboard_active() || c.in_failsafe() || offboard_ <= parameters_changed_) return;
  const Parameters& p = f.parameters();
  constexpr float kSlack = 1e-4f;
  for (std::size_t k = 0; k < 6; ++k) {
    if ((static_cast<unsigned>(c.primary_axes()) >> k & 1u) != 0) continue;
    const float value = c.combined().value[k];
    float limit = 1.0f;
    switch (c.combined().type[k]) {
      case CommandType::kAngle:
        limit = p.get_float(k == 3 ? Param::kRcMaxRoll : Param::kRcMaxPitch);
        break;
      case CommandType::kRate:
        limit = p.get_float(k == 3   ? Param::kRcMaxRollrate
                            : k == 4 ? Param::kRcMaxPitchrate
                                     : Param::kRcMaxYawrate);
        break;
      case CommandType::kThrottle:
        break;
      case CommandType::kPassThrough:
        continue;
    }
    if (!(std::abs(value) <= limit + kSlack)) {
      fail("offboard_limits", words("entry ", k, " is ", value, ", limit ", limit));
    }
  }
}

void FlightInvariants::check_arming(const WatchedFirmware& watched) {
  const Firmware& f = watched.firmware();
  if (!f.state().armed() || armed_before_) return;
  armed_at_ = now_;
  stick_raised_ = !(throttle_ < f.parameters().get_float(Param::kRcArmThreshold));
  commanded_ = false;
  on_ground_ = !(above_idle_at_disarm_ && now_ - disarmed_at_ <= kInAir);
  if (!asked_) fail("arming_asked", "armed, but nobody asked for it");
  if (!on_ground_) {
    ++coverage_.armed_in_air;
    return;
  }
  ++coverage_.armed_on_ground;
  // What ends the storing of parameters comes before the frame of the same pass.
  if (!(std::min(throttle_before_, throttle_) < f.parameters().get_float(Param::kRcArmThreshold))) {
    fail("arming_throttle_low", words("armed with the throttle stick at ", throttle_));
  }
  if (f.state().errors() != 0 && parameters_changed_ != now_) {
    fail("arming_without_errors", words("armed with error word ", f.state().errors()));
  }
}

void FlightInvariants::check_disarming(const WatchedFirmware& watched) {
  constexpr Time kSwitchTime = hal::milliseconds(250);
  constexpr int kSwitchFrames = 6;
  constexpr Time kCornerTime = hal::milliseconds(1300);
  const State state = watched.firmware().state().state();
  const bool may_fly = watched.firmware().state().armed() || state == State::kCalibrating;
  if (!may_fly) return;
  if (off_frames_ >= kSwitchFrames && rc_good_ - off_since_ > kSwitchTime) {
    fail("disarm_obeyed", words("arm switch off for ", hal::to_ms(now_ - off_since_), " ms"));
  }
  if (in_corner_ && now_ == rc_good_ && now_ - corner_since_ > kCornerTime) {
    fail("disarm_obeyed",
         words("sticks in the corner for ", hal::to_ms(now_ - corner_since_), " ms"));
  }
}

// ---- work, state, parameters

void FlightInvariants::check_work(const WatchedFirmware& watched) {
  const PassWork& w = watched.work();
  if (w.messages_decoded > kMaxMessages) {
    fail("work_messages", words(w.messages_decoded, " messages in a pass"));
  }
  if (w.bytes_read > kMaxBytesRead) fail("work_bytes_read", words(w.bytes_read, " B read"));
  if (w.bytes_encoded > kMaxBytesEncoded) {
    fail("work_bytes_encoded", words(w.bytes_encoded, " B sent"));
  }
  if (w.settings_derived > 1) {
    fail("work_settings", words("settings derived ", w.settings_derived, " times"));
  }
  if (w.storage_while_armed > 0) {
    fail("storage_while_armed", words(w.storage_while_armed, " blocks written or read",
                                      armed_before_ ? "" : " in the pass of arming"));
  }
  if (w.storage_writes > 1) {
    fail("work_storage", words(w.storage_writes, " blocks written"));
  }
  if (w.watchdog_fed < 1) fail("watchdog", "not fed");
}

void FlightInvariants::check_state(const WatchedFirmware& watched) {
  static const auto kReach = reachable();
  const StateMachine& s = watched.firmware().state();
  const bool flying = s.state() == State::kArmed || s.state() == State::kFailsafe;
  if (s.armed() != flying) {
    fail("armed_by_state",
         words("armed is ", s.armed(), " in state ", static_cast<int>(s.state())));
  }
  if (s.state() == State::kFailsafe && !s.failsafe())
    fail("armed_by_state", "failsafe without flag");
  if (watched.restarted() || coverage_.passes <= 1) return;
  const Situation before{before_, armed_before_, failsafe_before_};
  const Situation after{s.state(), s.armed(), s.failsafe()};
  if (kReach[index_of(before)][index_of(after)]) return;
  fail("transition_by_table",
       words("state ", static_cast<int>(before.state), " to ", static_cast<int>(after.state),
             ", armed ", before.armed, " to ", after.armed, ", failsafe ", before.failsafe, " to ",
             after.failsafe));
}

void FlightInvariants::check_parameters(const WatchedFirmware& watched) {
  const bool armed = watched.firmware().state().armed();
  const bool due = --until_scan_ <= 0 || watched.work().received_parameters || !values_known_ ||
                   armed != armed_before_;
  if (!due) return;
  until_scan_ = kPassesPerScan;
  const Parameters& p = watched.firmware().parameters();
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    const std::uint32_t bits = p.bits(id);
    const bool changed = !values_known_ || bits != values_[k];
    values_[k] = bits;
    if (!changed) continue;
    const ParamRow& row = Parameters::row(id);
    const ParamValue value =
        row.type == ParamType::kInt32 ? ParamValue{p.get_int(id)} : ParamValue{p.get_float(id)};
    const std::string name(row.name.data(), strnlen(row.name.data(), row.name.size()));
    if (!Parameters::in_range(id, value)) fail("parameters_in_range", name);
    if (values_known_ && armed && armed_before_ && armed_at_scan_ &&
        detail::kArmedRules[row.armed_rule].factor == 0.0f) {
      fail("locked_while_armed", name + " changed while armed");
    }
  }
  values_known_ = true;
  armed_at_scan_ = armed;
}

void FlightInvariants::check_twin(const WatchedFirmware& watched, const WatchedFirmware& twin) {
  const char* const name = has_foreign_ ? "message_for_another_system" : "equal_input_equal_output";
  const Firmware& a = watched.firmware();
  const Firmware& b = twin.firmware();
  const auto fail = [this, name](const std::string& detail) {
    differs_ = true;
    this->fail(name, detail);
  };
  if (!same_bits(watched.outputs(), twin.outputs())) fail("outputs differ");
  if (a.state().state() != b.state().state() || a.state().errors() != b.state().errors() ||
      a.state().armed() != b.state().armed() || a.state().failsafe() != b.state().failsafe()) {
    fail("states differ");
  }
  if (!same_bits(a.command().combined().value, b.command().combined().value)) {
    fail("commands differ");
  }
  if (watched.work().bytes_encoded != twin.work().bytes_encoded) {
    fail(words(watched.work().bytes_encoded, " B sent, the twin ", twin.work().bytes_encoded));
  }
  if (until_scan_ > 1 && !watched.work().received_parameters) return;
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    if (a.parameters().bits(id) != b.parameters().bits(id)) {
      const auto& text = Parameters::row(id).name;
      fail("parameters differ: " + std::string(text.data(), strnlen(text.data(), 16)));
    }
  }
}

}  // namespace rosflight::core
