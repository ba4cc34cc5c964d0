// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "base/constants.hpp"
#include "flight/project_root.hpp"
#include "sim/fixedwing/fixedwing.hpp"
#include "sim/quadplane/quadplane.hpp"
#include "sim/sensors/register.hpp"
#include "sim/world_sensors/world_sensors.hpp"

namespace rosflight::flight {
namespace {

using config::Error;

sim::Registry& fill(sim::Registry& registry, const FlightChoice& choice) {
  sim::register_physics(registry);
  sim::sensors::register_sensors(registry);
  sim::register_world_sensors(registry);
  for (const std::string& plugin : choice.plugins) registry.load_plugin(plugin);
  registry.add_vehicles(project_root() / "vehicles");
  return registry;
}

sim::Vehicle open_vehicle(sim::Registry& registry, const FlightChoice& choice) {
  std::vector<std::string> overrides = choice.overrides;
  if (choice.wind) {
    for (std::string& text : wind_overrides(*choice.wind)) overrides.push_back(std::move(text));
  }
  return fill(registry, choice).open_vehicle(choice.vehicle, std::move(overrides));
}

std::string find_mission(const std::string& wanted, const sim::Vehicle& vehicle) {
  std::string name = wanted;
  if (wanted == "default" && is_fixed_wing(vehicle)) name = "fixedwing";
  if (wanted == "default" && is_quadplane(vehicle)) name = "quadplane";
  const bool path = name.find('/') != std::string::npos || name.find(".yaml") != std::string::npos;
  if (path) return name;
  const std::filesystem::path folder = project_root() / "missions";
  const std::filesystem::path file = folder / (name + ".yaml");
  if (std::filesystem::exists(file)) return file.string();
  std::vector<std::string> known;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") known.push_back(entry.path().stem().string());
  }
  std::sort(known.begin(), known.end());
  throw Error(
      fmt::format("mission: found '{}', allowed a file or {}", name, fmt::join(known, ", ")));
}

/// Whether the other kind of aircraft could fly it, with its default limits.
bool is_for_the_other_kind(const std::string& mission_file, bool fixed_wing,
                           const base::Geodetic& origin) {
  try {
    if (fixed_wing) {
      autonomy::multirotor::load_mission(mission_file, {}, origin);
    } else {
      autonomy::fixedwing::load_mission(mission_file, {}, origin);
    }
    return true;
  } catch (const Error&) {
    return false;
  }
}

Plan read_own_plan(const sim::Vehicle& vehicle, const sim::MultirotorParameters& rotors,
                   const companion::ParameterSet& firmware, const std::string& mission_file) {
  const base::Geodetic& origin = vehicle.environment().origin;
  if (is_fixed_wing(vehicle)) {
    FixedWingPlan plan;
    plan.autonomy = read_fixedwing_autonomy(vehicle);
    plan.mission = autonomy::fixedwing::load_mission(mission_file, plan.autonomy.mission, origin);
    return plan;
  }
  if (is_quadplane(vehicle)) {
    QuadplanePlan plan;
    plan.autonomy = read_quadplane_autonomy(vehicle);
    plan.mission = autonomy::quadplane::load_mission(mission_file, plan.autonomy.mission, origin);
    return plan;
  }
  MultirotorPlan plan;
  plan.autonomy = read_multirotor_autonomy(vehicle, rotors, firmware);
  plan.mission = autonomy::multirotor::load_mission(mission_file, plan.autonomy.mission, origin);
  return plan;
}

Plan read_plan(const sim::Vehicle& vehicle, const sim::MultirotorParameters& rotors,
               const companion::ParameterSet& firmware, const std::string& mission_file) {
  try {
    return read_own_plan(vehicle, rotors, firmware, mission_file);
  } catch (const Error& error) {
    if (is_quadplane(vehicle)) throw;
    const bool fixed_wing = is_fixed_wing(vehicle);
    if (!is_for_the_other_kind(mission_file, fixed_wing, vehicle.environment().origin)) throw;
    throw Error(fmt::format("{}; this mission is for a {}, the vehicle is a {}", error.what(),
                            fixed_wing ? "multirotor" : "fixed wing",
                            fixed_wing ? "fixed wing" : "multirotor"));
  }
}

constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

std::vector<ShownWaypoint> shown(const Plan& plan) {
  std::vector<ShownWaypoint> out;
  if (const auto* fixedwing = std::get_if<FixedWingPlan>(&plan)) {
    using autonomy::fixedwing::Passing;
    const auto& waypoints = fixedwing->mission.waypoints;
    const bool cycle = fixedwing->mission.at_end == autonomy::AtEnd::kCycle;
    for (std::size_t k = 0; k < waypoints.size(); ++k) {
      const auto& wp = waypoints[k];
      const bool corner = wp.passing == Passing::kFillet && (cycle || k + 1 < waypoints.size());
      const bool fly_by = corner || wp.passing == Passing::kCircle;
      out.push_back({wp.p_W, wp.passing == Passing::kDubins ? wp.course_rad : kNotGiven, wp.hold_s,
                     fly_by ? PassMeasure::kFlyBy : PassMeasure::kPoint});
    }
    return out;
  }
  if (const auto* quadplane = std::get_if<QuadplanePlan>(&plan)) {
    const auto& waypoints = quadplane->mission.waypoints_W;
    for (const sim::Vector3& p_W : waypoints) {
      const bool last = &p_W == &waypoints.back();
      out.push_back({p_W, kNotGiven, 0.0, last ? PassMeasure::kPoint : PassMeasure::kFlyBy});
    }
    return out;
  }
  for (const auto& wp : std::get<MultirotorPlan>(plan).mission.waypoints) {
    out.push_back({wp.p_W, wp.psi_rad, wp.hold_s,
                   wp.figure_turns > 0 ? PassMeasure::kFigure : PassMeasure::kPoint});
  }
  return out;
}

/// Some waypoint is given by latitude and longitude.
bool names_places_on_earth(const std::string& mission_file) {
  const auto file = autonomy::MissionFile::load(mission_file);
  return std::any_of(file.waypoints.begin(), file.waypoints.end(), [](const config::Section& wp) {
    return wp.boolean("use_lla", false) || wp.boolean("lla", false);
  });
}

double throttle_that_carries(const Plan& plan, const sim::Vehicle& vehicle,
                             const companion::ParameterSet& firmware) {
  if (const auto* fixedwing = std::get_if<FixedWingPlan>(&plan)) {
    return fixedwing->autonomy.flight.controller.throttle_cruise;
  }
  if (const auto* quadplane = std::get_if<QuadplanePlan>(&plan)) {
    const auto& facts = quadplane->autonomy.flight.vehicle;
    return facts.mass_kg * facts.gravity_m_s2 /
           (facts.max_lift_force_N * firmware_value(firmware, "RC_MAX_THR"));
  }
  return std::get<MultirotorPlan>(plan).autonomy.flight.thrust.throttle(
      vehicle.body().mass_kg * vehicle.environment().gravity_m_s2);
}

}  // namespace

std::string read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

sim::rc::ChannelMap channels_of(const companion::ParameterSet& firmware) {
  using sim::rc::Control;
  sim::rc::ChannelMap map;
  const auto set = [&](Control control, const char* parameter) {
    map[control] = static_cast<int>(firmware_value(firmware, parameter));
  };
  set(Control::kRoll, "RC_X_CHN");
  set(Control::kPitch, "RC_Y_CHN");
  set(Control::kThrottle, "RC_F_CHN");
  set(Control::kYaw, "RC_Z_CHN");
  set(Control::kArm, "RC_ARM_CHN");
  set(Control::kAttitudeOverride, "RC_ATT_OVRD_CHN");
  set(Control::kThrottleOverride, "RC_THR_OVRD_CHN");
  set(Control::kAttitudeMode, "RC_ATT_CTRL_CHN");
  return map;
}

WindChoice parse_wind(const std::string& text) {
  std::vector<double> numbers;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const auto number = config::parse_number(text.substr(at, end - at));
    if (!number) {
      numbers.clear();
      break;
    }
    numbers.push_back(*number);
    at = end + 1;
  }
  const bool shaped = numbers.size() == 2 || numbers.size() == 3;
  if (!shaped || numbers[0] < 0.0 || numbers[0] > 40.0 || std::abs(numbers[1]) > 360.0 ||
      (numbers.size() == 3 && (numbers[2] < 0.0 || numbers[2] > 40.0))) {
    throw Error(fmt::format(
        "--wind: found '{}', allowed SPEED,FROM_DEG[,W20] with speeds from 0 to 40 m/s", text));
  }
  const double from_rad = numbers[1] * base::kPi / 180.0;
  WindChoice wind;
  wind.steady_W_m_s = {-numbers[0] * std::cos(from_rad), -numbers[0] * std::sin(from_rad), 0.0};
  if (numbers.size() == 3) wind.w20_m_s = numbers[2];
  return wind;
}

std::vector<std::string> wind_overrides(const std::string& text) {
  const WindChoice wind = parse_wind(text);
  std::vector<std::string> overrides{
      fmt::format("environment.wind.steady_W_m_s=[{:.9g}, {:.9g}, 0]", wind.steady_W_m_s.x(),
                  wind.steady_W_m_s.y())};
  if (wind.w20_m_s) {
    overrides.push_back(fmt::format("environment.wind.turbulence_w20_m_s={:.9g}", *wind.w20_m_s));
  }
  return overrides;
}

bool FlightChoice::has_chip() const {
  return std::find(kChipBoards.begin(), kChipBoards.end(), board) != kChipBoards.end();
}

FlightSetup::FlightSetup(const FlightChoice& choice_in)
    : choice{choice_in},
      vehicle{open_vehicle(registry, choice)},
      rotors{read_rotors(vehicle)},
      firmware{read_firmware_parameters(vehicle)},
      estimator{read_estimator(vehicle)},
      mission_file{find_mission(choice.mission, vehicle)},
      plan{read_plan(vehicle, rotors, firmware, mission_file)},
      waypoints{shown(plan)},
      score_radius_m{std::visit([](const auto& of) { return of.mission.score_radius_m; }, plan)},
      hover_throttle{throttle_that_carries(plan, vehicle, firmware)},
      channels{channels_of(firmware)},
      faults{sim::parse_faults(choice.faults)} {
  mission_text = read_text(mission_file);
  if (names_places_on_earth(mission_file)) {
    // Such a mission was converted from here: the estimate counts from the same place on the map,
    // not from where the first fixes of a flight place it.
    estimator.origin = vehicle.environment().origin;
  }
  if (choice.link == "uart" && choice.board != "qemu_m7") {
    throw Error(fmt::format("--link: found uart with --board {}, allowed with --board qemu_m7",
                            choice.board));
  }
  if (choice.link == "usb" && !choice.has_chip()) {
    throw Error(fmt::format("--link: found usb with --board {}, allowed with --board {}",
                            choice.board, fmt::join(kChipBoards, ", ")));
  }
  if (choice.has_chip() && choice.link_protocol != "mavlink") {
    throw Error(fmt::format("--link-protocol: found {} with --board {}, allowed mavlink",
                            choice.link_protocol, choice.board));
  }
  for (const sim::Fault& fault : faults.faults()) check(fault);
}

void FlightSetup::check(const sim::Fault& fault) const {
  const bool servo = fault.kind == sim::FaultKind::kServo;
  if (!servo && fault.kind != sim::FaultKind::kMotor) return;
  const auto tilting = std::ranges::count_if(
      rotors.rotors, [](const sim::RotorParameters& rotor) { return rotor.tilt.has_value(); });
  std::size_t surfaces = static_cast<std::size_t>(tilting);
  if (fixed_wing()) surfaces = sim::read_fixed_wing(vehicle.root()).surfaces.size();
  if (quadplane()) surfaces = sim::read_quadplane(vehicle.root()).surfaces.size();
  const std::size_t count = servo ? surfaces : rotors.rotors.size();
  if (fault.motor < count) return;
  throw Error(fmt::format(
      "--fault: found {} {}, allowed {}", servo ? "servo" : "motor", fault.motor,
      count == 0 ? "none: this vehicle has no surfaces" : fmt::format("0 to {}", count - 1)));
}

}  // namespace rosflight::flight
