// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "apps/fly/cable_ends.hpp"
#include "apps/fly/firmware_board.hpp"
#include "apps/fly/flight_director.hpp"
#include "apps/fly/flight_setup.hpp"
#include "apps/fly/navigator.hpp"
#include "apps/fly/tracking.hpp"
#include "apps/fly/wing_record.hpp"
#include "link/detect/detecting_codec.hpp"
#include "sim/dynamics/rigid_body.hpp"
#include "sim/faulty_modules.hpp"
#include "sim/lock_step.hpp"
#include "sim/sensors/register.hpp"
#include "sim/sensors/standard_sensors.hpp"
#include "sim/time_sources.hpp"

namespace rosflight::apps {

/// One flight, all of it in this process and in lock-step: world, board with the real firmware,
/// cable, companion, autonomy, pilot. A function of the setup alone: the same setup gives the same
/// bits.
class Flight final : private sim::LockStepListener {
 public:
  static constexpr sim::Time kStep{2500};  ///< 400 Hz, the rate of the IMU.

  /// @param setup  must outlive this.
  /// @param guide  of your own (docs/autonomy/replace-a-module.md); none: the project's.
  explicit Flight(const FlightSetup& setup, std::unique_ptr<Guide> guide = nullptr);

  /// Sees every frame on the cable, or nullptr.
  void set_tap(LinkTap* tap);
  void add(sim::Visualiser& visualiser) { loop_.add(visualiser); }
  /// Called at the beginning of each step, after the director; tests play their part here.
  void set_script(std::function<void(Flight&, sim::Time)> script) { script_ = std::move(script); }
  /// Puts something between the loop and the board, such as a meter; it must outlive the flight.
  void replace_board(sim::BoardModule& board) { board_slot_.board = &board; }
  /// Real time instead of as fast as possible.
  void set_pace(sim::TimeSource& time) { time_.source = &time; }

  void step() { loop_.step(); }
  /// Steps until the director is finished.
  void run() {
    while (!director_.finished()) loop_.step();
  }

  sim::Time now() const { return loop_.now(); }
  const FlightSetup& setup() const { return setup_; }
  const sim::Truth& truth() const { return dynamics_.truth(); }
  sim::RigidBody& dynamics() { return dynamics_; }
  sim::ForcesAndMoments& forces() { return *forces_; }
  FlightDirector& director() { return director_; }
  const FlightDirector& director() const { return director_; }
  /// The board that flies.
  FlightBoard& flight_board() { return *flown_board_; }
  const FlightBoard& flight_board() const { return *flown_board_; }
  /// The newest IMU sample that the board was given; its stamp is simulated time.
  const std::optional<hal::ImuSample>& imu() const { return board_slot_.imu; }
  /// The board in this process, which lets one look inside; it flies unless the setup names
  /// another.
  FirmwareBoard& board() { return board_; }
  const FirmwareBoard& board() const { return board_; }
  companion::Session& session() { return session_; }
  sim::rc::Pilot& pilot() { return pilot_; }
  sim::SerialCable& cable() { return cable_; }
  const GuideOutput& autonomy() const { return guide_->output(); }
  Guide& guide() { return *guide_; }
  const Guide& guide() const { return *guide_; }
  /// Against the commanded path as it was meant.
  const Tracking& tracking() const { return tracking_; }
  /// The same, horizontal, less the slow error of the satellites, which nothing on board can see:
  /// truth + error of GNSS - error of the origin - commanded. On the truth: horizontal, as it is.
  const Tracking& own_tracking() const { return own_tracking_; }
  /// Null unless a fixed wing flies.
  const WingRecord* wing_record() const { return wing_record_ ? &*wing_record_ : nullptr; }
  const Navigator& navigator() const { return *navigator_; }
  /// Of the truth, in the estimator's frame as the satellites have it; for judging estimates.
  sim::Vector3 seen_position_N() const;
  /// Motor output that holds the vehicle in the air, by the vehicle file's numbers.
  double firmware_hover_output() const;

 private:
  /// Lets the pace be chosen after the loop was built.
  struct SwitchableTime final : sim::TimeSource {
    sim::TimeSource* source{};
    sim::Time advance(sim::Time now) override { return source->advance(now); }
  };

  struct SwitchableBoard final : sim::BoardModule {
    sim::BoardModule* board{};
    std::optional<hal::ImuSample> imu;  ///< The last that the board was given.
    const hal::OutputValues& step(sim::Time t, const sim::SensorSamples& samples,
                                  const hal::RcFrame* rc) override {
      if (samples.has_imu) imu = samples.imu;
      return board->step(t, samples, rc);
    }
    bool armed() const override { return board->armed(); }
  };

  void before_step(sim::Time t) override;
  void apply_faults(sim::Time t);
  void face_the_wind();

  const FlightSetup& setup_;
  sim::RandomSource random_;
  std::unique_ptr<sim::ForcesAndMoments> forces_;
  sim::RigidBody dynamics_;
  std::unique_ptr<sim::SensorsModule> healthy_sensors_;
  sim::FaultySensors sensors_;
  sim::rc::Pilot pilot_;
  sim::FaultyRc rc_;
  sim::Time wire_time_{};
  sim::SerialCable cable_;
  BoardEnd board_end_;
  CompanionEnd companion_end_;
  FirmwareBoard board_;
  std::unique_ptr<FlightBoard> other_board_;  ///< If the setup names one.
  FlightBoard* flown_board_;
  SwitchableBoard board_slot_;
  link::DetectingCodec codec_;
  companion::Session session_;
  std::unique_ptr<Guide> guide_;
  std::unique_ptr<Navigator> navigator_;
  FlightDirector director_;
  sim::LockStepTime fast_;
  SwitchableTime time_;
  sim::LockStep loop_;
  std::vector<std::unique_ptr<sim::Visualiser>> visualisers_;  ///< Those the setup names.
  std::function<void(Flight&, sim::Time)> script_;
  Tracking tracking_;
  Tracking own_tracking_;
  const FixedWingGuide* wing_guide_{};  ///< Null unless the project's guidance flies a fixed wing.
  std::optional<WingRecord> wing_record_;
  const sim::sensors::StandardSensors* instruments_{};  ///< Null for a module of someone else's.
  bool motor_faults_{false};
  std::array<bool, 2> broken_down_{};  ///< Crash and hang have had their moment.
};

}  // namespace rosflight::apps
