// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "sim/registry.hpp"
#include "sim/test/world.hpp"

namespace rosflight::sim::test {
namespace {

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const config::Error& error) {
    return error.what();
  }
  return "no error";
}

/// What loading the default vehicle with an override says, without its place in the front.
std::string message_with(const std::string& override_text) {
  std::string message = message_of([&] {
    Registry registry;
    register_physics(registry);
    const Vehicle vehicle = Vehicle::from_file(kVehicleFile, {override_text});
    registry.make_forces(vehicle, RandomSource{1});
  });
  for (const std::string& place : {"--set " + override_text + ": ", kVehicleFile + ":"}) {
    if (message.starts_with(place)) {
      const auto start = message.find(": ", place.size() - 2) + 2;
      return message.substr(start);
    }
  }
  return message;
}

TEST(Vehicle, DefaultQuadrotorHasItsPublishedNumbers) {
  const Vehicle vehicle = Vehicle::from_file(kVehicleFile);
  EXPECT_EQ(vehicle.type(), "multirotor");
  EXPECT_EQ(vehicle.body().mass_kg, 3.5);
  EXPECT_EQ(vehicle.body().inertia_kg_m2.diagonal(), Vector3(0.08, 0.08, 0.12));
  EXPECT_EQ(vehicle.environment().origin.altitude_m, 1387.0);
  const MultirotorParameters rotors = read_multirotor(vehicle.root());
  ASSERT_EQ(rotors.rotors.size(), 4U);
  EXPECT_NEAR(rotors.rotors[0].p_B.head<2>().norm(), 0.25, 5e-5);
  EXPECT_EQ(rotors.motor.torque_constant_Nm_A, 0.028937);
  EXPECT_NO_THROW(vehicle.finish());
}

TEST(Vehicle, SectionsShareNumbersByReference) {
  const Vehicle vehicle = Vehicle::from_file(kVehicleFile);
  const auto estimator = vehicle.autonomy().section("estimator");
  EXPECT_EQ(estimator.numbers("imu_position_m", 3, config::Range::any()),
            (std::vector<double>{0.02, 0.0, -0.02}));
}

TEST(Vehicle, FileMayExtendAnother) {
  const auto folder = std::filesystem::temp_directory_path() / "rosflight_vehicle_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "heavy.yaml")
      << "extends: " << std::filesystem::absolute(kVehicleFile).string()
      << "\nbody: {mass_kg: 5}\n";
  std::ofstream(folder / "heavier.yaml") << "extends: heavy.yaml\nbody:\n  mass_kg: -6\n";
  std::ofstream(folder / "own.yaml") << "extends: multirotor\nbody:\n  mass_kg: 4\n";
  EXPECT_EQ(Vehicle::from_file(folder / "own.yaml", {}, "vehicles").body().mass_kg, 4.0);
  EXPECT_THROW(Vehicle::from_file(folder / "own.yaml"), config::Error);
  std::ofstream(folder / "round.yaml") << "extends: round.yaml\n";
  const Vehicle heavy = Vehicle::from_file(folder / "heavy.yaml");
  EXPECT_EQ(heavy.body().mass_kg, 5.0);
  EXPECT_EQ(heavy.body().inertia_kg_m2(2, 2), 0.12);
  EXPECT_NO_THROW(read_multirotor(heavy.root()));
  EXPECT_NO_THROW(heavy.finish());
  EXPECT_EQ(message_of([&] { Vehicle::from_file(folder / "heavier.yaml"); }),
            (folder / "heavier.yaml").string() +
                ":3: body.mass_kg: found -6, allowed a number > 0 and <= 100000");
  EXPECT_EQ(message_of([&] { Vehicle::from_file(folder / "round.yaml"); }),
            (folder / "round.yaml").string() +
                ":1: extends: found a chain of more than 8 files, allowed a shorter one");
  std::filesystem::remove_all(folder);
}

TEST(Vehicle, WrittenTextIsTheSameVehicle) {
  const Vehicle vehicle = Vehicle::from_file(kVehicleFile, {"body.mass_kg=4.25"});
  const Vehicle again{config::Document::from_text(vehicle.text(), "again.yaml")};
  EXPECT_EQ(again.body().mass_kg, 4.25);
  EXPECT_EQ(again.text(), vehicle.text());
}

TEST(Vehicle, ReadsTheFormerKeyOfTheMaximumStep) {
  EXPECT_EQ(Vehicle::from_file(kVehicleFile, {"body.longest_step_s=0.002"}).body().max_step_s,
            0.002);
}

TEST(Vehicle, BadValuesAreNamedInOneLine) {
  EXPECT_EQ(message_with("type=submarine"),
            "type: found submarine, allowed fixedwing, multirotor, quadplane");
  EXPECT_EQ(message_with("body.mass_kg=-1"),
            "body.mass_kg: found -1, allowed a number > 0 and <= 100000");
  EXPECT_EQ(message_with("body.mass_kg=3.5 kg"),
            "body.mass_kg: found 3.5 kg, allowed a number > 0 and <= 100000");
  EXPECT_EQ(message_with("body.mas_kg=3.5"),
            "body.mas_kg: found an unknown key, allowed mass_kg, inertia_kg_m2, center_of_mass_m, "
            "integration, max_step_s");
  EXPECT_EQ(message_with("wings.area_m2=1").substr(0, 28), "wings: found an unknown key,");
  EXPECT_EQ(message_with("body.inertia_kg_m2.zz=0.2"),
            "body.inertia_kg_m2: found principal moments 0.08, 0.08, "
            "0.2, allowed "
            "positive ones, none more than 2 % above the sum of the others");
  EXPECT_EQ(message_with("body.inertia_kg_m2.xy=0.09").substr(0, 47),
            "body.inertia_kg_m2: found principal moments -0.");
  EXPECT_EQ(message_with("body.integration=euler"),
            "body.integration: found euler, allowed rk4, frozen_forces");
  EXPECT_EQ(message_with("rotors.layout=[]"), "rotors.layout: found 0 entries, allowed 1 to 10");
  EXPECT_EQ(message_with("rotors.layout.1.output=0"),
            "rotors.layout.1.output: found 0 again, allowed each output once");
  EXPECT_EQ(message_with("rotors.layout.1.output=14"),
            "rotors.layout.1.output: found 14, allowed an integer from 0 to 13");
  EXPECT_EQ(message_with("rotors.layout.2.spin=0"),
            "rotors.layout.2.spin: found 0, allowed -1 or 1");
  EXPECT_EQ(message_with("rotors.layout.2.thrust_direction=[0, 0, 0]"),
            "rotors.layout.2.thrust_direction: found [0, 0, 0], allowed a unit vector");
  EXPECT_EQ(message_with("rotors.motor.model=instant"),
            "rotors.motor.model: found instant with a battery of cells, allowed electrical, "
            "first_order, or "
            "battery.model constant");
  EXPECT_EQ(message_with("rotors.motor.model=first_order"),
            "rotors.motor.time_constant_s: found nothing, allowed a "
            "number from 0.002 "
            "to 10");
  EXPECT_EQ(message_with("rotors.propeller.thrust_coefficients=[0, 1]"),
            "rotors.propeller.thrust_coefficients: found a list of 2, allowed a list of 3 numbers, "
            "each a number from "
            "-1 to 1");
  EXPECT_EQ(message_with("rotors.propeller.torque_coefficients=[-0.1, 0, 0]"),
            "rotors.propeller.torque_coefficients: found [-0.1, 0, 0], allowed a first one > 0");
  EXPECT_EQ(message_with("battery.initial_charge=1.1"),
            "battery.initial_charge: found 1.1, allowed a number from 0 to 1");
  EXPECT_EQ(message_with("battery.open_circuit_cell_V=[3.7]"),
            "battery.open_circuit_cell_V: found [3.7], allowed two or more");
  EXPECT_EQ(message_with("battery.model=constant"),
            "battery.constant_voltage_V: found nothing, allowed a "
            "number > 0 and <= 1000");
  EXPECT_EQ(message_with("aero.ground_effect=strong"),
            "aero.ground_effect: found strong, allowed none, cheeseman_bennett, polynomial");
  EXPECT_EQ(message_with("ground.contacts_m=[]"),
            "ground.contacts_m: found an empty list, allowed one or more");
  EXPECT_EQ(message_with("ground.contacts_m=[[1, 2]]"),
            "ground.contacts_m.0: found a list of 2, allowed a list of 3 numbers, each a number "
            "from -20 to 20");
  EXPECT_EQ(message_with("ground.friction=.nan"),
            "ground.friction: found .nan, allowed a number from 0 to 10");
}

TEST(Vehicle, MissingSectionsAreNamed) {
  EXPECT_EQ(
      message_of([] { Vehicle{config::Document::from_text("type: multirotor\n", "v.yaml")}; }),
      "v.yaml:1: body: found nothing, allowed a map");
  EXPECT_EQ(message_of([] { Vehicle{config::Document::from_text("- 1\n", "v.yaml")}; }),
            "v.yaml:1: found a list of 1, allowed a map");
  EXPECT_EQ(message_of([] { Vehicle::from_file("vehicles/none.yaml"); }),
            "vehicles/none.yaml: found no such file, allowed a YAML file");
}

TEST(Registry, FindsVehiclesByNameAndByPath) {
  Registry registry;
  registry.add_vehicles("vehicles");
  EXPECT_EQ(registry.vehicle_file("multirotor"), "vehicles/multirotor.yaml");
  EXPECT_EQ(registry.vehicle_file("elsewhere/my.yaml"), "elsewhere/my.yaml");
  EXPECT_EQ(registry.vehicle_file("my.yaml"), "my.yaml");
  EXPECT_EQ(message_of([&] { registry.vehicle_file("zeppelin"); }).substr(0, 34),
            "vehicle: found zeppelin, allowed a");
  EXPECT_EQ(message_of([&] { registry.add_vehicles("nowhere"); }),
            "nowhere: found no such folder, allowed one with vehicle files");
}

TEST(Registry, KnowsEachNameOnce) {
  Registry registry;
  register_physics(registry);
  EXPECT_EQ(registry.forces.names(),
            (std::vector<std::string>{"fixedwing", "multirotor", "quadplane"}));
  EXPECT_EQ(message_of([&] { register_physics(registry); }),
            "type fixedwing: found a second one, allowed one of a name");
  EXPECT_EQ(message_of([&] { registry.visualisers.at("hologram"); }),
            "visualiser: found hologram, allowed none: nothing is registered");
  EXPECT_EQ(message_of([&] { registry.vehicles.add("", "x"); }),
            "vehicle: found an empty name, allowed a word");
}

TEST(Registry, RefusesWhatIsNoPlugin) {
  Registry registry;
  EXPECT_NE(
      message_of([&] { registry.load_plugin("nowhere/lib.so"); }).find("nowhere/lib.so: found "),
      std::string::npos);
  const auto text = std::filesystem::temp_directory_path() / "rosflight_no_plugin.so";
  std::ofstream(text) << "no library";
  EXPECT_NE(message_of([&] { registry.load_plugin(text); }).find("allowed a shared library"),
            std::string::npos);
  std::filesystem::remove(text);
}

}  // namespace
}  // namespace rosflight::sim::test
