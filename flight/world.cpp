// SPDX-License-Identifier: BSD-3-Clause
#include "flight/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "flight/flight.hpp"
#include "flight/gazebo/gazebo_engine.hpp"
#include "flight/jsbsim/jsbsim_engine.hpp"
#include "flight/vehicle_sdf.hpp"
#include "sim/dynamics/runge_kutta_engine.hpp"
#include "sim/sensors/register.hpp"
#include "sim/world/read_sdf.hpp"

namespace rosflight::flight {
namespace {

sim::rc::Script pilot_script(const FlightSetup& setup) {
  sim::rc::Script script;
  script.channels = setup.channels;
  return script;
}

bool has_world_sensors(const FlightSetup& setup) {
  return !setup.vehicle.world_sensors().keys().empty();
}

/// What sensors of the world see: what the body can touch, and the shapes of --world.
sim::world::WorldShapes make_shapes(const FlightSetup& setup) {
  if (!has_world_sensors(setup)) return {};
  const std::string& file = setup.choice.world;
  sim::world::WorldShapes shapes;
  if (!file.empty()) shapes = sim::world::read_sdf_world(file);
  const bool replaced = !file.empty() && setup.choice.physics == "gazebo";
  if (!replaced && setup.vehicle.ground().model != sim::GroundModel::kNone)
    shapes.add_level_ground();
  return shapes;
}

/// From so high a vehicle may fall onto the ground of a world at its start: 3.1 m/s, which is no crash.
constexpr double kMaxDrop_m = 0.5;

double lowest_point_m(const sim::GroundParameters& ground) {
  double lowest_m = 0.0;
  for (const sim::Vector3& point : ground.contacts_B) lowest_m = std::max(lowest_m, point.z());
  return lowest_m;
}

std::unique_ptr<sim::PhysicsEngine> make_engine(const FlightSetup& setup) {
  const std::string& physics = setup.choice.physics;
  const std::string& world = setup.choice.world;
  if (!world.empty() && physics != "gazebo" && !has_world_sensors(setup))
    throw config::Error(fmt::format(
        "--world: found {} with --physics {}, allowed with gazebo or with world_sensors "
        "in the vehicle file",
        world, physics));
  const sim::BodyParameters& body = setup.vehicle.body();
  const double gravity_m_s2 = setup.vehicle.environment().gravity_m_s2;
  if (physics == "runge_kutta") return nullptr;
  if (physics == "runge_kutta_held")
    return std::make_unique<sim::RungeKuttaEngine>(body, gravity_m_s2);
  if (physics == "jsbsim") {
    return std::make_unique<JsbsimEngine>(body, gravity_m_s2, JsbsimEngine::Options::of_project());
  }
  if (physics == "gazebo") {
    GazeboEngine::Options options = GazeboEngine::Options::of_project();
    options.world_file = world;
    options.max_height_m = lowest_point_m(setup.vehicle.ground()) + kMaxDrop_m;
    return std::make_unique<GazeboEngine>(vehicle_sdf(setup.vehicle, "vehicle", SdfModel::kOneLink),
                                          gravity_m_s2, options);
  }
  throw config::Error(
      fmt::format("--physics: found {}, allowed {}", physics, fmt::join(kPhysics, ", ")));
}

std::unique_ptr<sim::SensorsModule> make_sensors(const FlightSetup& setup,
                                                 const sim::RandomSource& random) {
  if (setup.choice.has_chip()) {
    return sim::sensors::make_exposure(setup.registry, setup.vehicle, random, kChipStep,
                                       Flight::kStep);
  }
  return sim::sensors::make_sensors(setup.registry, setup.vehicle, random);
}

}  // namespace

World::World(const FlightSetup& flight_setup, std::unique_ptr<sim::PhysicsEngine> given)
    : setup{flight_setup},
      random{setup.choice.seed},
      forces{setup.registry.make_forces(setup.vehicle, random)},
      dynamics{setup.vehicle.body(), setup.vehicle.ground(), setup.vehicle.environment(), *forces,
               random},
      engine{given ? std::move(given) : make_engine(setup)},
      healthy_sensors{make_sensors(setup, random)},
      shapes{make_shapes(setup)},
      world_sensors{setup.registry, setup.vehicle, shapes, random, Flight::kStep},
      faults{setup.faults},
      sensors{*healthy_sensors, faults},
      pilot{pilot_script(setup)},
      rc{pilot, faults},
      cable{random} {
  if (engine) dynamics.set_engine(*engine);
  if (const auto* gazebo = dynamic_cast<const GazeboEngine*>(engine.get()))
    world_sha256 = gazebo->world_sha256();
  const std::string& wanted = setup.choice.world_sha256;
  if (!wanted.empty() && world_sha256 != wanted)
    throw config::Error(
        fmt::format("--repeat: found {} or what it refers to with SHA-256 {:.8}, allowed {:.8}, "
                    "that of the flight, "
                    "whose world.sdf is in its folder and log",
                    setup.choice.world, world_sha256, wanted));
  if (setup.winged()) face_the_wind();
}

/// An aircraft with a wing takes off against the wind, if the wind exceeds kCalm_m_s. It is held until
/// then, with a cover on its pitot tube while it is set up.
void World::face_the_wind() {
  constexpr double kCalm_m_s = 2.0;
  dynamics.set_held(true);
  const sim::Vector3& wind_W = setup.vehicle.environment().wind.steady_W_m_s;
  if (wind_W.head<2>().norm() < kCalm_m_s) return;
  const double heading = std::atan2(-wind_W.y(), -wind_W.x());
  sim::BodyState state = dynamics.rest_state();
  state.q_WB = sim::Quaternion(std::cos(0.5 * heading), 0.0, 0.0, std::sin(0.5 * heading));
  if (!dynamics.set_state(state)) throw std::logic_error("the start against the wind");
}

void World::apply_link_faults(sim::Time t) {
  sim::SerialCable& line = cable.cable();
  const bool cut = faults.active(sim::FaultKind::kLinkCut, t);
  if (cut != line.to_board.cut()) {
    line.advance(t);
    line.set_cut(cut);
  }
  const double noise = std::min(faults.value(sim::FaultKind::kLinkNoise, t), 1.0);
  if (noise == link_noise) return;
  link_noise = noise;
  line.advance(t);
  line.set_corruption(noise);
}

void World::apply_faults(sim::Time t, Autopilot& autopilot) {
  apply_link_faults(t);
  using Breakdown = Autopilot::Breakdown;
  for (const auto& [kind, breakdown] : {std::pair{sim::FaultKind::kCrash, Breakdown::kCrash},
                                        std::pair{sim::FaultKind::kHang, Breakdown::kHang}}) {
    bool& done = broken_down[static_cast<std::size_t>(breakdown)];
    const bool active = faults.active(kind, t);
    if (active && !done) autopilot.break_down(t, breakdown);
    done = active;
  }
  apply_actuator_faults(faults, t, *forces);
}

}  // namespace rosflight::flight
