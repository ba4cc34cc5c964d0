// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <optional>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/common/types.hpp"
#include "autonomy/fixedwing/config.hpp"
#include "autonomy/fixedwing/controller.hpp"
#include "autonomy/fixedwing/path_follower.hpp"
#include "autonomy/multirotor/controller.hpp"
#include "flight/flight_setup.hpp"

namespace rosflight::python {

inline constexpr std::size_t kActions = 4;

/// The loops that the companion of a mission flies by, for a velocity or a waypoint as actions state them. Hides of
/// which kind the vehicle is. Positions, velocities and courses are those of the state that step() is given.
class CompanionLoops {
 public:
  using Numbers = std::array<double, kActions>;  ///< An action, each -1 to 1.

  CompanionLoops() = default;
  CompanionLoops(const CompanionLoops&) = delete;
  CompanionLoops& operator=(const CompanionLoops&) = delete;
  virtual ~CompanionLoops() = default;

  /// Those of this vehicle, with the gains and limits of its section `autonomy`. Not for quad-planes.
  static std::unique_ptr<CompanionLoops> make(const flight::FlightSetup& setup);

  /// An episode begins: without integrals.
  virtual void restart() = 0;
  /// A velocity, as docs/gymnasium/README.md has it for this kind of vehicle.
  virtual void fly_velocity(const Numbers& a, const autonomy::StateEstimate& state) = 0;
  /// A point as seen from where the vehicle is now, likewise.
  virtual void fly_waypoint(const Numbers& a, const autonomy::StateEstimate& state) = 0;
  /// The command at `state`, dt_s after the one before. @param battery_voltage_V  of which the thrust depends.
  virtual autonomy::FirmwareCommand step(const autonomy::StateEstimate& state, double dt_s,
                                         double battery_voltage_V) = 0;
};

class MultirotorLoops final : public CompanionLoops {
 public:
  /// Distance of a waypoint at an action of 1, along each axis.
  static constexpr double kReach_m = 5.0;

  explicit MultirotorLoops(const autonomy::multirotor::AutonomyConfig& config);
  void restart() override { controller_ = fresh_; }
  void fly_velocity(const Numbers& a, const autonomy::StateEstimate& state) override;
  void fly_waypoint(const Numbers& a, const autonomy::StateEstimate& state) override;
  void fly_to(const autonomy::Vector3& p_W, double heading_rad);
  autonomy::FirmwareCommand step(const autonomy::StateEstimate& state, double dt_s,
                                 double battery_voltage_V) override;

 private:
  autonomy::multirotor::Controller fresh_;
  autonomy::multirotor::Controller controller_;
  autonomy::multirotor::ControllerCommand wanted_;
};

class FixedWingLoops final : public CompanionLoops {
 public:
  /// Horizontal distance of a waypoint at an action of 1, in turn radii: what a half turn takes.
  static constexpr double kReachRadii = 2.0;
  /// The altitude that a climb rate asks for stays this near to the vehicle's.
  static constexpr double kMaxLead_m = 5.0;

  /// @param config  copied.
  explicit FixedWingLoops(const autonomy::fixedwing::AutonomyConfig& config);
  void restart() override;
  void fly_velocity(const Numbers& a, const autonomy::StateEstimate& state) override;
  void fly_waypoint(const Numbers& a, const autonomy::StateEstimate& state) override;
  /// On a course over ground, at an altitude above the origin, at the speed of missions.
  void fly_course(double course_rad, double height_m);
  autonomy::FirmwareCommand step(const autonomy::StateEstimate& state, double dt_s,
                                 double battery_voltage_V) override;

 private:
  autonomy::fixedwing::FlightConfig config_;
  double min_airspeed_m_s_;
  double max_airspeed_m_s_;
  autonomy::fixedwing::PathFollower follower_;
  autonomy::fixedwing::Controller controller_;
  std::optional<autonomy::fixedwing::CurrentPath> path_;  ///< Absent: `wanted_` without a path.
  autonomy::fixedwing::ControllerCommand wanted_;
  std::optional<double>
      height_m_;  ///< What climb rates have made of the altitude; absent: its own.
};

}  // namespace rosflight::python
