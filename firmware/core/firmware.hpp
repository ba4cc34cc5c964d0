// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/mixer_setup.hpp"
#include "firmware/core/parameter_store.hpp"
#include "firmware/core/settings.hpp"
#include "firmware/core/telemetry.hpp"

namespace rosflight::core {

/// The autopilot. Owns every module, knows their order, and is the only one that reads the clock.
///
/// A board's main() builds it, calls start() once and run() for ever. Everything lives inside the
/// object: no heap, no globals, so any number of autopilots fit in one process.
class Firmware {
 public:
  /// An IMU that is silent for this long is not responding: multirotors stop their motors, fixed
  /// wings fly on the sticks, until it answers again.
  static constexpr Time kImuSilence = hal::milliseconds(100);

  Firmware(const hal::Board& board, link::Codec& codec);

  /// Brings the autopilot up: parameters, mixer, receiver, link, sensors, crash recovery.
  void start();

  /// One pass of the main loop. Call it without pause.
  void run();

  /// For a fault handler: leaves a record for the next start. The board resets afterwards.
  void record_fault(const std::array<std::uint32_t, 8>& registers);

  // What replay, tests and displays look at.
  const StateMachine& state() const { return state_; }
  const CommandManager& command() const { return command_; }
  const Estimator& estimator() const { return estimator_; }
  const Controller& controller() const { return controller_; }
  const Mixer& mixer() const { return mixer_; }
  const Sensors& sensors() const { return sensors_; }
  const Parameters& parameters() const { return parameters_; }
  const Log& log() const { return log_; }
  const Telemetry& telemetry() const { return telemetry_; }

  // The doors of the link, for replay: the same that messages take.
  void handle(const link::Message& message, Time now);

 private:
  // run(), step by step
  void sense(Time now);
  bool time_step(float& dt_s);
  void control(Time now, float dt_s);
  void receive(Time now);
  void supervise(Time now);
  void listen_to_pilot(Time now);
  void decide(Time now);

  // messages
  void on(const link::Heartbeat& message, Time now);
  void on(const link::TimeSync& message, Time now);
  void on(const link::ParamRequestRead& message);
  void on(const link::ParamRequestList& message);
  void on(const link::ParamSet& message);
  void on(const link::CommandRequest& message, Time now);
  void on(const link::OffboardControl& message, Time now);
  bool run_command(link::Command command, Time now);
  bool is_me(std::uint8_t target_system) const;

  // parameters
  void apply_parameter_changes();
  void apply_settings();
  void apply_mixers();
  void update_max_thrust();
  void check_calibration();
  void check_failsafe();
  StoreResult load_parameters();
  bool save_parameters();

  // state
  void act(std::uint16_t actions, Time now);
  void set_error(Error error, bool on);
  void refuse(std::uint16_t actions, Time now);
  void recover_from_crash();
  void watch_imu(Time now);
  void watch_battery(Time now);
  void show_leds(Time now);
  void capture_trim();
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
  Controller controller_;
  Mixer mixer_;
  Telemetry telemetry_;

  hal::RcFrame rc_frame_{};  ///< The newest; a member so that a pass without one need not clear it.
  Time pass_begin_{};
  Time longest_pass_{};  ///< From one pass to the next, since it was last told.
  Time imu_stamp_{};     ///< Of the previous sample.
  Time imu_heard_{};     ///< When it came.
  Time fallback_written_{};
  Time reboot_at_{Time::max()};
  float max_thrust_N_{1.0f};
  std::uint16_t fault_count_{0};
  std::int16_t loop_time_us_{0};
  bool reboot_to_bootloader_{false};
  bool imu_known_{false};
  bool pilot_new_{false};
  std::array<bool, 2> leds_{};
  RateLimit refusals_{hal::milliseconds(1000)};
  RateLimit saturation_texts_{hal::milliseconds(1000)};
  RateLimit motor_model_texts_{hal::milliseconds(1000)};
  RateLimit battery_texts_{hal::milliseconds(10000)};
  RateLimit offboard_texts_{hal::milliseconds(1000)};
};

}  // namespace rosflight::core
