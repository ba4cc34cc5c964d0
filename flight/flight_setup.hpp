// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "autonomy/quadplane/mission.hpp"
#include "flight/vehicle/quadplane_setup.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "flight/waypoint_score.hpp"
#include "sim/faults.hpp"
#include "sim/multirotor/multirotor_parameters.hpp"
#include "sim/rc/pilot.hpp"
#include "sim/registry.hpp"
#include "sim/types.hpp"

namespace rosflight::flight {

/// The boards with an emulated STM32H7, as FlightChoice::board spells them.
inline constexpr std::array<const char*, 3> kChipBoards{"pixracer_pro", "varmint", "varmint_10x"};

/// Their time step: the period of the fastest gyro. Firmware, parts and body take turns in it.
inline constexpr sim::Time kChipStep{500};

/// What can move the body, as FlightChoice::physics spells it: the integrator of sim/dynamics, forces and body
/// together; the same behind the interface of an engine, with the load held over a step; JSBSim; Gazebo's dartsim.
inline constexpr std::array<const char*, 4> kPhysics{"runge_kutta", "runge_kutta_held", "jsbsim",
                                                     "gazebo"};

/// What a person chose for a flight; names and texts as typed.
struct FlightChoice {
  std::string board{"in_process"};  ///< Or "qemu_m7", or one of kChipBoards.
  std::string link{"cable"};        ///< Or "uart", of qemu_m7, in real time; or "usb".
  std::string vehicle{"multirotor"};
  std::string mission{"default"};  ///< "default": the mission of the vehicle's kind.
  std::uint64_t seed{1};
  std::string link_protocol{"mavlink"};  ///< What the board speaks: mavlink or lean.
  std::string state{"estimate"};         ///< What guidance flies on: estimate or truth.
  std::string pilot{"hover"};            ///< The safety pilot's throttle stick: hover or idle.
  std::string physics{"runge_kutta"};    ///< One of kPhysics.
  std::string world;                     ///< SDF file, with physics gazebo; empty: our flat ground.
  std::string world_sha256;              ///< What its files must have; empty: any.
  std::vector<std::string> overrides;    ///< "body.mass_kg=3.2"
  std::vector<std::string> faults;       ///< "baro@20:5"
  std::vector<std::string> plugins;      ///< Shared libraries.
  std::vector<std::string> visualisers;  ///< Names that a plugin registered.
  std::optional<std::string> wind;       ///< "SPEED,FROM_DEG[,W20]"

  /// Whether the board is one of kChipBoards.
  bool has_chip() const;
};

struct MultirotorPlan {
  autonomy::multirotor::AutonomyConfig autonomy;
  autonomy::multirotor::Mission mission;
};
struct FixedWingPlan {
  autonomy::fixedwing::AutonomyConfig autonomy;
  autonomy::fixedwing::Mission mission;
};
struct QuadplanePlan {
  autonomy::quadplane::AutonomyConfig autonomy;
  autonomy::quadplane::Mission mission;
};
using Plan = std::variant<MultirotorPlan, FixedWingPlan, QuadplanePlan>;

/// A waypoint as score and report see it.
struct ShownWaypoint {
  sim::Vector3 p_W{sim::Vector3::Zero()};
  double heading_rad{};  ///< NaN: none was asked for.
  double hold_s{};
  PassMeasure measure{PassMeasure::kPoint};
};

/// Everything a flight needs, read and checked. @throws config::Error, one line.
///
/// Vehicles are found by name in vehicles/, missions in missions/, both also as paths.
struct FlightSetup {
  explicit FlightSetup(const FlightChoice& choice);

  FlightChoice choice;
  sim::Registry registry;
  sim::Vehicle vehicle;
  sim::MultirotorParameters rotors;  ///< Rotors; the propulsion of a fixed wing.
  companion::ParameterSet firmware;
  autonomy::estimation::EstimatorConfig estimator;
  std::string mission_file;
  std::string mission_text;
  Plan plan;
  std::vector<ShownWaypoint> waypoints;
  double score_radius_m{};  ///< How near the truth must pass each of them.
  double hover_throttle{};  ///< Stick that carries the vehicle: hovering, or in cruise.
  sim::rc::ChannelMap channels;
  sim::FaultSchedule faults;

  bool fixed_wing() const { return std::holds_alternative<FixedWingPlan>(plan); }
  bool quadplane() const { return std::holds_alternative<QuadplanePlan>(plan); }
  bool winged() const { return fixed_wing() || quadplane(); }

  /// @throws config::Error  this vehicle has no such motor or surface.
  void check(const sim::Fault& fault) const;
};

/// All of a file; empty: it cannot be read.
std::string read_text(const std::string& file);

/// Receiver channels as the firmware will look for them.
sim::rc::ChannelMap channels_of(const companion::ParameterSet& firmware);

struct WindChoice {
  sim::Vector3 steady_W_m_s{sim::Vector3::Zero()};
  std::optional<double> w20_m_s;  ///< Wind at 20 ft, which sets the turbulence.
};
/// "8,270,5": 8 m/s from the west, turbulence as with 5 m/s at 20 ft. @throws config::Error
WindChoice parse_wind(const std::string& text);
/// The same as overrides of a vehicle file.
std::vector<std::string> wind_overrides(const std::string& text);

}  // namespace rosflight::flight
