// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/register.hpp"

#include <gtest/gtest.h>

#include <string>

#include "sim/sensors/read_config.hpp"
#include "sim/sensors/test/samples.hpp"

namespace rosflight::sim::sensors {
namespace {

/// A user's own: a barometer that always shows what the vehicle file says.
class BrokenBarometer : public SensorsModule {
 public:
  explicit BrokenBarometer(double pressure_Pa) : pressure_Pa_{pressure_Pa} {}
  void step(const Truth& truth, SensorSamples& samples) override {
    samples = {};
    samples.has_baro = true;
    samples.baro.stamp = truth.time;
    samples.baro.pressure_Pa = static_cast<float>(pressure_Pa_);
  }

 private:
  double pressure_Pa_;
};

/// The default vehicle with other sensors.
Vehicle vehicle_with(const std::string& sensors) {
  return Vehicle::from_file("vehicles/multirotor.yaml", {"sensors=" + sensors});
}

TEST(RegisterSensors, TheDefaultVehicleHasTheStandardModule) {
  Registry registry;
  register_sensors(registry);
  const Vehicle vehicle = Vehicle::from_file("vehicles/multirotor.yaml");
  const auto module = make_sensors(registry, vehicle, RandomSource{1});
  SensorSamples samples;
  module->step(at_rest(), samples);
  EXPECT_TRUE(samples.has_imu);
  // Errors of current hardware: close to the truth and not the truth.
  EXPECT_NEAR(static_cast<double>(samples.imu.accel_m_s2[2]), -kTestGravity, 0.5);
  EXPECT_NE(samples.imu.accel_m_s2[2], static_cast<float>(-kTestGravity));
}

TEST(RegisterSensors, AnotherModuleIsFoundByNameAndReadsTheSection) {
  Registry registry;
  register_sensors(registry);
  registry.sensors.add("broken", [](const Vehicle& vehicle, const RandomSource&) {
    const double pressure_Pa = vehicle.sensors().number("pressure_Pa", config::Range::positive());
    vehicle.sensors().finish();
    return std::make_unique<BrokenBarometer>(pressure_Pa);
  });
  const Vehicle vehicle = vehicle_with("{module: broken, pressure_Pa: 77}");
  SensorSamples samples;
  make_sensors(registry, vehicle, RandomSource{1})->step(at_rest(), samples);
  EXPECT_EQ(samples.baro.pressure_Pa, 77.0F);
}

TEST(RegisterSensors, AnUnknownModuleIsAMistake) {
  Registry registry;
  register_sensors(registry);
  const Vehicle vehicle = vehicle_with("{module: mine}");
  try {
    static_cast<void>(make_sensors(registry, vehicle, RandomSource{1}));
    FAIL() << "no error";
  } catch (const config::Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "--set sensors={module: mine}: sensors.module: found mine, allowed standard");
  }
  // The standard module, constructed directly, does not follow the file.
  EXPECT_THROW(static_cast<void>(read_sensors(vehicle.sensors())), config::Error);
}

}  // namespace
}  // namespace rosflight::sim::sensors
