// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/arming_checks.hpp"
#include "firmware/core/learned_controller.hpp"
#include "firmware/core/mixer_setup.hpp"
#include "firmware/core/motor_stop.hpp"
#include "firmware/core/parameter_store.hpp"
#include "firmware/core/pass_counters.hpp"
#include "firmware/core/settings.hpp"
#include "firmware/core/telemetry.hpp"

namespace rosflight::core {

/// The autopilot. Owns every module, defines their order, and alone reads the clock.
///
/// A board's main() constructs it, calls start() once and run() for ever. All state is inside the
/// object: no heap, no globals, so any number of autopilots fit in one process.
class Firmware {
 public:
  /// Without a sample for this long the IMU is not responding: multirotors stop their motors and
  /// fixed wings follow the sticks directly, until samples arrive again.
  static constexpr Time kImuSilence = hal::milliseconds(100);
  /// An armed vehicle without IMU samples keeps its last outputs so long, counted from the last.
  static constexpr Time kImuHold = hal::milliseconds(300);
  /// After arming on the ground the motors turn at idle for this long, unless the throttle stick is
  /// raised or the companion sends a command.
  static constexpr Time kIdleFirst = hal::milliseconds(500);
  /// Arming on the ground requires that the vehicle did not turn for this long.
  static constexpr Time kStillTime = hal::milliseconds(500);
  /// Arming within this time of a disarming with motors above idle counts as arming in the air.
  static constexpr Time kRearmInAir = hal::milliseconds(1000);
  /// A fixed wing may be in the air for this long after its motor turned above idle.
  static constexpr Time kGlide = hal::milliseconds(30'000);
  /// A motor test ends this long after its last message.
  static constexpr Time kMotorTestTime = hal::milliseconds(300);
  static constexpr float kMotorTestLimit = 0.3f;
  /// Limits of the link's work in one pass: 400 passes a second keep up with 3 000 000 baud. Further
  /// messages wait in their order.
  static constexpr int kMessagesPerPass = 8;
  static constexpr int kRequestCounts = 2;  ///< A request counts double: it is also answered.
  static constexpr std::size_t kBytesPerPass = 1024;
  /// Without a valid frame for this long the companion no longer commands auxiliary motors.
  static constexpr Time kCompanionSilence = hal::milliseconds(1000);

  /// @param board  the roles that it names must outlive this. @param codec  likewise.
  // cold: runs once, so the compiler makes it small rather than fast.
  [[gnu::cold]] Firmware(const hal::Board& board, link::Codec& codec);

  /// Starts up: parameters, mixer, receiver, link, sensors, crash recovery.
  [[gnu::cold]] void start();

  /// One pass of the main loop. Call it without pause.
  void run();

  /// For a fault handler: writes a record for the next start. The board must reset afterwards.
  void record_fault(const std::array<std::uint32_t, 8>& registers);

  // For replay, tests and displays.
  const StateMachine& state() const { return state_; }
  const CommandManager& command() const { return command_; }
  const Estimator& estimator() const { return estimator_; }
  const Controller& controller() const { return controller_; }
  const LearnedController& learned() const { return learned_; }
  const Mixer& mixer() const { return mixer_; }
  const Sensors& sensors() const { return sensors_; }
  const Parameters& parameters() const { return parameters_; }
  const Log& log() const { return log_; }
  const Telemetry& telemetry() const { return telemetry_; }
  const MotorStop& motor_stop() const { return motor_stop_; }
  const PassCounters& counters() const { return counters_; }
  /// The checks before arming, evaluated now.
  CheckResults checks(Time now) const;
  /// The measured voltage is that of a battery, and below kLowBatteryFraction of BATT_VOLT_MAX.
  bool battery_low() const;
  /// Faults in a row that ended with a restart, this start after the last of them; 0 after a reset on command.
  unsigned faults() const { return fault_count_; }

  /// A text of the board: sent as those of the firmware are.
  void report(Severity severity, const Text& text) { log_.push(severity, text); }

  /// Handles one message as if it had been received; for replay.
  void handle(const link::Message& message, Time now);

 private:
  /// The bytes that arrived before this pass and are not yet decoded. Stale: the vehicle armed while
  /// they waited, so commands among them are discarded.
  enum class Queue : std::uint8_t { kEmpty, kWaiting, kStale };

  // run(), step by step
  void sense(Time now);
  void finish_calibration(const Sensors::CalibrationEvents& events, Time now);
  bool time_step(float& dt_s);
  void control(Time now, float dt_s);
  const CommandVector& learned_command(const AttitudeEstimate& attitude, float dt_s);
  bool fits_policy() const;
  bool policy_may_fly(const CommandVector& command) const;
  void describe_policy();
  void judge_estimator();
  Mixer::Conditions mixer_conditions(Time now);
  void receive(Time now);
  bool refill();
  void take_messages(Time now);
  void supervise(Time now);
  void read_pilot(Time now);
  void lose_receiver(Time now);
  void decide(Time now);

  // messages
  void on(const link::Heartbeat& message, Time now);
  void on(const link::TimeSync& message, Time now);
  void on(const link::ParamRequestRead& message);
  void on(const link::ParamRequestList& message);
  void on(const link::ParamSet& message, Time now);
  void on(const link::CommandRequest& message, Time now);
  void on(const link::OffboardControl& message, Time now);
  void on(const link::MotorTest& message, Time now);
  void on(const link::ReportRequest& message);
  bool run_command(link::Command command, Time now);
  bool is_me(std::uint8_t target_system) const;
  static bool is_request(const link::Message& message);
  static bool is_command(const link::Message& message);
  void note_multiplier(Param id);
  void answer_with(Param id);
  void report_losses(Time now);
  void report_sensors(Time now);
  void report_sensor_changes();

  // parameters
  void apply_parameter_changes();
  void apply_settings();
  void apply_mixers();
  void update_max_thrust();
  void correct_throttle();
  void check_calibration();
  void forget_accel_calibration();
  void check_failsafe();
  StoreResult load_parameters();
  bool save_parameters();
  void begin_save();
  bool begin_write();
  void continue_save(Time now);

  // state
  void act(Actions actions, Time now);
  /// Passes the event to the state machine and does what it asks for.
  void note(Event event, Time now);
  void set_error(Error error, bool on);

  // arming, and what ends it (firmware_arming.cpp)
  void request_arming(Time now);
  ArmRequest arm_request(Time now) const;
  void armed_now(Actions actions, Time now);
  void disarmed_now(Time now);
  void refuse(Time now);
  void warn_before_arming(Time now);
  Text check_text(Check check, Time now) const;
  bool in_flight(Time now) const;
  bool above_idle() const;
  bool may_glide(Time now) const;
  bool turning() const;
  bool motors_enabled() const { return state_.armed() && !motor_stop_.stopped(); }
  bool still_holding_idle(Time now);
  void stop_motors();
  void report_motor_stop();
  void watch_motion(Time now);
  void watch_motor_test(Time now);
  void report_checks(Time now);
  void send_counters();
  void recover_from_crash(Time started);
  void watch_imu(Time now);
  void watch_battery(Time now);
  void show_leds(Time now);
  bool capture_trim();
  link::Status status() const;

  hal::Board board_;
  link::Codec& codec_;
  Log log_;
  Parameters parameters_;
  ParameterStore store_;
  StateMachine state_;
  Sensors sensors_;
  Estimator estimator_;
  Rc rc_;
  CommandManager command_;
  LearnedController learned_{built_in_policy()};
  Controller controller_;
  Mixer mixer_;
  Telemetry telemetry_;
  MotorStop motor_stop_;
  SensorWatch sensor_watch_;
  PassCounters counters_;

  std::array<std::uint8_t, 128> incoming_{};  ///< Bytes of the link, from incoming_used_ on.
  std::size_t incoming_size_{0};
  std::size_t incoming_used_{0};
  std::array<std::uint32_t, 3> reported_losses_{};  ///< Frames in and out, texts.
  std::array<bool, kAidCount> reported_silent_{};
  std::uint16_t reported_sensor_errors_{0};
  bool sensor_errors_wait_{false};  ///< The last report found errors that are not reported yet.
  float max_thrust_N_{1.0f};        ///< Max thrust of all motors, by parameters and density.
  RateLimit sensor_texts_{hal::milliseconds(10000)};
  RateLimit loss_texts_{hal::milliseconds(10000)};
  hal::RcFrame rc_frame_{};  ///< The newest; a member so that a pass without one need not clear it.
  Time pass_begin_{};
  Time max_pass_{};                       ///< Longest time between passes since the last report.
  Time moved_{hal::milliseconds(-1000)};  ///< When the disarmed vehicle last turned.
  Time idle_until_{};                     ///< End of kIdleFirst, while holding_idle_.
  Time powered_{Time::min() / 2};         ///< Fixed wing: last time with a motor above idle.
  Time disarmed_{};                       ///< When it was disarmed with motors above idle.
  Time test_until_{};                     ///< When the motor test ends.
  std::size_t next_check_{kCheckCount};   ///< Next line of the report on checks.
  CrashRecord::Ages rearm_ages_ms_{CrashRecord{}.rearm_age_ms};  ///< At the start.
  float test_value_{0.0f};
  std::int8_t test_motor_{-1};
  bool holding_idle_{false};
  bool rearm_in_air_{false};
  Queue queue_{Queue::kEmpty};
  bool accel_calibrated_{false};  ///< And none of its biases set since.
  bool stop_reported_{false};
  bool save_requested_{false};
  bool storage_healthy_{true};
  bool stored_{false};                ///< This pass wrote a block to storage.
  bool write_again_{false};           ///< WRITE_PARAMS came while a save was under way.
  std::uint8_t writes_requested_{0};  ///< Acknowledgements that are due at its end.
  Time last_imu_{};                   ///< When the last usable sample came.
  Time last_companion_frame_{};       ///< Its newest valid frame.
  Time fallback_written_{};
  Time reboot_at_{Time::max()};
  std::uint16_t fault_count_{0};
  std::int16_t loop_time_us_{0};
  bool reboot_to_bootloader_{false};
  bool pilot_new_{false};
  std::array<bool, 2> leds_{};
  RateLimit refusals_{hal::milliseconds(1000)};
  RateLimit saturation_texts_{hal::milliseconds(1000)};
  RateLimit motor_model_texts_{hal::milliseconds(1000)};
  RateLimit battery_texts_{hal::milliseconds(10000)};
  RateLimit offboard_texts_{hal::milliseconds(1000)};
  RateLimit motor_test_texts_{hal::milliseconds(1000)};
  RateLimit limit_texts_{hal::milliseconds(1000)};
};

}  // namespace rosflight::core
