// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "flight/autopilot/autopilot.hpp"
#include "flight/error_statistics.hpp"
#include "flight/fixedwing_record.hpp"
#include "flight/flight_score.hpp"
#include "flight/flight_setup.hpp"
#include "flight/guidance.hpp"
#include "flight/mission_runner.hpp"
#include "flight/state_estimate_source.hpp"
#include "sim/dynamics/rigid_body.hpp"
#include "sim/modules.hpp"
#include "sim/world_sensors/world_sensors.hpp"

namespace rosflight::flight {

class CableLink;
struct TunedVehicle;
class InProcessAutopilot;

/// Modules of your own in place of the project's (docs/autonomy/replace-a-module.md); an empty
/// member means the project's.
// NOLINTBEGIN(readability-redundant-member-init): so that GCC lets callers name single members
struct FlightParts {
  std::unique_ptr<Guidance> guidance{};
  std::function<std::unique_ptr<StateEstimateSource>(companion::Session&)> estimate_source{};
  std::function<std::unique_ptr<Autopilot>(CableLink&)> autopilot{};
  std::unique_ptr<sim::PhysicsEngine> engine{};  ///< Moves the body, whatever `physics` says.
  /// Paces the loop, such as sim::PacedTime; must outlive the flight. nullptr: as fast as possible.
  sim::TimeSource* time{nullptr};
};
// NOLINTEND(readability-redundant-member-init)

/// One flight as a closed loop in this thread: world, autopilot with the real firmware, serial
/// cable, companion, autonomy and pilot. A function of setup and parts alone: the same setup gives
/// the same bits, unless the link is a UART in real time.
///
/// Positions are in the local north-east-down frame W; its origin is that of the vehicle file.
class Flight final {
 public:
  static constexpr sim::Time kStep{2500};  ///< 400 Hz, the rate of the IMU.

  /// @param setup  must outlive this.
  /// @throws config::Error  a module does not accept its configuration.
  /// @throws boards::m7::EmulatorError  no image, no emulator, or it does not start.
  explicit Flight(const FlightSetup& setup, FlightParts parts = {});
  ~Flight();
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  /// Shows every frame on the link to `tap`; nullptr: none.
  void set_tap(LinkTap* tap);
  /// Adds a visualiser, called at the end of each step; it must outlive the flight.
  void add(sim::Visualiser& visualiser);
  /// Called with each sample of a sensor of the world, at the time of its arrival; an empty function: nobody.
  using WorldReceiver =
      std::function<void(sim::Time, const std::string& name, const sim::WorldSample&)>;
  void set_world_receiver(WorldReceiver receiver);
  const sim::WorldSensors& world_sensors() const;
  /// Called in each step before the firmware runs, after the mission runner.
  void set_script(std::function<void(Flight&, sim::Time)> script);

  /// Advances by kStep.
  void step();
  /// step() in two halves, for FlightParts::engine that another program moves in between: the load of the step, from all
  /// modules up to the forces; then the engine has its new state. @throws std::logic_error  another engine moves, or
  /// the board takes substeps.
  sim::PhysicsEngine::Load begin_step();
  void end_step();
  /// Steps until finished().
  void run();
  /// The mission runner is finished and, where it has failed, the vehicle is down for a second or
  /// kAfterFailure has passed.
  bool finished() const;
  static constexpr sim::Time kAfterFailure = std::chrono::seconds(30);
  /// How it went so far. @param interrupted  a person stops it here.
  FlightScore score(bool interrupted = false) const;

  sim::Time now() const;  ///< Start of the next step.
  const FlightSetup& setup() const;
  /// SHA-256 of the file of the world and all that it refers to; empty: no such world.
  const std::string& world_sha256() const;
  const sim::Truth& truth() const;
  const sim::RigidBody& dynamics() const;
  MissionRunner& runner();
  const MissionRunner& runner() const;
  Autopilot& autopilot();
  const Autopilot& autopilot() const;
  /// The autopilot if it is the project's in this process. @throws std::bad_cast otherwise.
  InProcessAutopilot& in_process();
  /// The newest IMU sample that the autopilot has received; its stamp is simulated time.
  const std::optional<hal::ImuSample>& imu() const;
  companion::Session& session();
  sim::rc::Pilot& pilot();
  Guidance& guidance();
  /// Those of the setup, and what is added in flight. In force from the step that begins.
  sim::FaultSchedule& faults();
  /// From the step that begins on: another wind, as Wind::set().
  void set_wind(const sim::Vector3& steady_W_m_s, double w20_m_s);
  /// One gust that begins now, as Wind::add_gust().
  void add_gust(const sim::Vector3& peak_W_m_s, double duration_s);
  /// The vehicle file as it is in force: that of the setup, and what was tuned in flight.
  const std::string& vehicle_text() const;
  /// Takes it into use. @throws config::Error  the guidance is one that cannot.
  void tune(const TunedVehicle& vehicle);
  const Guidance& guidance() const;
  /// Output of guidance in its last step.
  const GuidanceOutput& autonomy() const { return guidance().output(); }
  const StateEstimateSource& estimate_source() const;

  /// Distance of the true position from the setpoint [m], while the mission is followed.
  const ErrorStatistics& tracking() const;
  /// The same for seen_position_W(), horizontally [m].
  const ErrorStatistics& own_tracking() const;
  /// nullptr unless a fixed wing flies.
  const FixedWingRecord* fixedwing_record() const;
  /// The true position [m] in the frame of the estimate: truth + error of GNSS when the frame was
  /// placed - error of the origin. What differs from it is the error of the estimator. On the truth:
  /// the truth.
  sim::Vector3 seen_position_W() const;

 private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace rosflight::flight
