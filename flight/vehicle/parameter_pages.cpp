// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle/parameter_pages.hpp"

#include "autonomy/estimation/read_estimator.hpp"
#include "autonomy/fixedwing/config.hpp"
#include "autonomy/multirotor/config.hpp"
#include "autonomy/quadplane/config.hpp"
#include "config/table.hpp"
#include "flight/vehicle/mixer_page.hpp"
#include "sim/parameter_tables.hpp"
#include "sim/sensors/presets.hpp"
#include "sim/sensors/read_config.hpp"
#include "sim/world_sensors/depth_camera.hpp"
#include "sim/world_sensors/lidar.hpp"
#include "sim/world_sensors/motion_capture.hpp"

namespace rosflight::flight {
namespace {

const std::string kMade =
    "Made from the tables of parameters in the code by the program `parameter_pages`; a test "
    "compares.\n";

template <class S>
std::string keys(const std::string& heading, const std::string& text, const config::Table<S>& table,
                 const S& defaults = {}) {
  return "\n## " + heading + "\n\n" + text + "\n" + table.page(defaults);
}

std::string autonomy_page() {
  return "# Keys of the section `autonomy` of a vehicle file\n\n" + kMade +
         "Every key may be left out: its default then holds. `--set "
         "vehicle.autonomy.follower.drag_1_s=0` changes one\n"
         "for a flight. `vehicles/defaults` has files with all defaults, to copy from.\n" +
         keys("Multirotor",
              "`autonomy/multirotor/config.cpp`. Mass, gravity, rotors, RC_MAX_THR and "
              "USE_MOTOR_PARAM come from the other\nsections.",
              autonomy::multirotor::parameters()) +
         keys("Fixed wing",
              "`autonomy/fixedwing/config.cpp`. Mass, wing, density and derivatives come from the "
              "other sections.",
              autonomy::fixedwing::parameters()) +
         keys("Quad-plane",
              "`autonomy/quadplane/config.cpp`. Mass, inertia, wing, derivatives and rotors come "
              "from the other sections.",
              autonomy::quadplane::parameters()) +
         keys("Estimator of all: section `autonomy.estimator`",
              "`autonomy/estimation/read_estimator.cpp`; the algorithm: "
              "`docs/autonomy/estimation.md`.",
              autonomy::estimation::parameters());
}

std::string vehicle_page() {
  return "# Keys of a vehicle file\n\n" + kMade +
         "The other sections: `vehicles/README.md`, `docs/autonomy-keys.md`.\n" +
         keys("Section `body`", "`sim/dynamics/read_body.cpp`.", sim::body_parameters()) +
         keys("Section `rotors`", "`sim/multirotor/read_multirotor.cpp`.",
              sim::rotor_parameters()) +
         keys("Section `battery`", "`sim/multirotor/read_multirotor.cpp`.",
              sim::battery_parameters()) +
         keys("Section `aero` of a multirotor", "`sim/multirotor/read_multirotor.cpp`.",
              sim::aero_parameters()) +
         keys("Section `aero` of a fixed wing",
              "`sim/fixedwing/read_fixedwing.cpp`; the equations: `docs/design/physics.md`.",
              sim::airframe_parameters()) +
         keys("Section `rotor_aero` of a quad-plane, what its lifting rotors and booms add",
              "`sim/quadplane/read_quadplane.cpp`.", sim::aero_parameters()) +
         keys("Section `surfaces` of a fixed wing", "`sim/fixedwing/read_fixedwing.cpp`.",
              sim::surface_parameters()) +
         keys("Section `ground`", "`sim/dynamics/read_ground.cpp`.", sim::ground_parameters()) +
         keys("Section `environment`",
              "`sim/environment/environment.cpp`. `start_utc`, such as 2026-06-01T12:00:00Z, is "
              "needed too.",
              sim::environment_parameters()) +
         keys("Section `sensors`",
              "`sim/sensors/read_config.cpp`. `preset` (current, reference, ideal) chooses the "
              "defaults; these are those of\n`current`, whose sources are in "
              "`sim/sensors/presets.cpp`. u is the unit in the name of the section around the key.",
              sim::sensors::sensor_tables(), sim::sensors::current_hardware()) +
         keys("Section `world_sensors`, keys of every sensor",
              "`sim/world_sensors`. Each sensor has a section of its name with `type`: lidar, "
              "depth_camera, motion_capture,\nor that of a plugin. Topics: "
              "`docs/simulation/world-sensors.md`.",
              sim::timing_table(), sim::Timing{true, sim::Lidar::Config{}.timing.period, {}, {}}) +
         keys("Where a sensor of the vehicle is", "Not of motion_capture.", sim::mounting_table()) +
         keys("Type `lidar`", "`sim/world_sensors/lidar.cpp`.", sim::Lidar::parameters()) +
         keys("Type `depth_camera`", "`sim/world_sensors/depth_camera.cpp`.",
              sim::DepthCamera::parameters()) +
         keys(
             "Type `motion_capture`",
             "`sim/world_sensors/motion_capture.cpp`; its default rate is 100 Hz. u is the unit in "
             "the name of the section.",
             sim::MotionCapture::parameters());
}

std::string mixers_page() {
  return "# Predefined mixers\n\n"
         "Made from the firmware's tables by the program `parameter_pages`; a test compares.\n\n"
         "![Mixers 0 to 10 from above, the nose up](img/mixers.svg)\n\n"
         "Seen from above, the nose up. A number is an output channel. Propellers drawn in blue "
         "turn to the left\n"
         "(counter-clockwise), those in orange to the right; their drag turns the nose the other "
         "way. Two motors on\n"
         "one arm of Y6 and X8 share an axis, one above the other.\n\n"
         "PRIMARY_MIXER or SECONDARY_MIXER selects one by its id. Output of a channel: the sum of "
         "gain times input, inputs\n"
         "forces and torques in body axes front-right-down, not in newtons: `docs/mixer.md`.\n\n" +
         mixer_tables();
}

template <class S>
std::string autonomy_file(const std::string& kind, const config::Table<S>& table) {
  const autonomy::estimation::EstimatorConfig estimator;
  return "# All keys of the section autonomy of a " + kind +
         " with their defaults: docs/autonomy-keys.md.\n# A key that is left out has its default. "
         "Commented keys have none of their own.\nautonomy:\n" +
         table.commented({}, 1) + "\n  # State estimate.\n  estimator:\n" +
         autonomy::estimation::parameters().commented(estimator, 2);
}

}  // namespace

std::vector<ParameterPage> parameter_pages() {
  return {{"docs/autonomy-keys.md", autonomy_page()},
          {"docs/vehicle-keys.md", vehicle_page()},
          {"vehicles/defaults/multirotor.yaml",
           autonomy_file("multirotor", autonomy::multirotor::parameters())},
          {"vehicles/defaults/fixedwing.yaml",
           autonomy_file("fixed wing", autonomy::fixedwing::parameters())},
          {"vehicles/defaults/quadplane.yaml",
           autonomy_file("quad-plane", autonomy::quadplane::parameters())},
          {"docs/img/mixers.svg", mixer_picture()},
          {"docs/predefined-mixers.md", mixers_page()}};
}

}  // namespace rosflight::flight
