// SPDX-License-Identifier: BSD-3-Clause
// From a command through the firmware's mixer to what the surfaces do in the simulator.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/core/mixer.hpp"
#include "firmware/core/mixer_frames.hpp"
#include "flight/flight_setup.hpp"
#include "sim/fixedwing/fixedwing.hpp"

namespace rosflight::flight {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

sim::Vehicle load(const std::string& name, const std::vector<std::string>& options = {}) {
  return sim::Vehicle::from_file("vehicles/" + name + ".yaml", options);
}

/// The firmware's mixer as the vehicle's parameters have it, and the vehicle's surfaces behind it.
class Chain {
 public:
  explicit Chain(const sim::Vehicle& vehicle) : wing_{sim::read_fixed_wing(vehicle.root())} {
    const companion::ParameterSet set = read_firmware_parameters(vehicle);
    const auto on = [&set](const char* name) { return firmware_value(set, name) != 0.0; };
    core::Mixer::Config config;
    config.fixed_wing = on("FIXED_WING");
    config.reverse_aileron = on("REV_AILERON");
    config.reverse_elevator = on("REV_ELEVATOR");
    config.reverse_rudder = on("REV_RUDDER");
    config.spin_when_armed = on("ARM_SPIN_MOTORS");
    mixer_.configure(config);
    const auto id =
        static_cast<core::MixerId>(static_cast<int>(firmware_value(set, "PRIMARY_MIXER")));
    mixer_.set_header(core::frame_header(id));
    mixer_.primary() = mixer_.secondary() = core::frame_gains(id);
    mixer_.set_valid(true);
  }

  core::Mixer& mixer() { return mixer_; }

  /// Where surfaces are a long time after entries 3, 4, 5 of a command.
  sim::Deflection settled(float roll, float pitch, float yaw) {
    core::Mixer::Conditions armed;
    armed.armed = true;
    const hal::OutputValues& outputs = mixer_.step({0.5F, 0, 0, roll, pitch, yaw}, armed);
    EXPECT_FLOAT_EQ(outputs[4], 0.5F);
    std::vector<double> x(wing_.state_size());
    std::vector<double> x_dot(wing_.state_size());
    const sim::BodyState body;
    const sim::Matrix3 R = sim::Matrix3::Identity();
    const sim::Air air;
    sim::Wrench wrench;
    for (int i = 0; i < 1000; ++i) {
      wing_.evaluate({body, R, body.v_B, air, outputs, 100.0}, x, wrench, x_dot);
      for (std::size_t k = 0; k < x.size(); ++k) x[k] += 1e-3 * x_dot[k];
    }
    return wing_.deflection(outputs, x);
  }

  /// Angular acceleration the surfaces give at 15 m/s, up to the moments of inertia [N m].
  sim::Vector3 moment(float roll, float pitch, float yaw) {
    sim::Wrench with;
    sim::Wrench without;
    wing_.airframe().add_wrench({15, 0, 0}, sim::Vector3::Zero(), 1.2, settled(roll, pitch, yaw),
                                with);
    wing_.airframe().add_wrench({15, 0, 0}, sim::Vector3::Zero(), 1.2, {}, without);
    return with.torque_B - without.torque_B;
  }

 private:
  sim::FixedWing wing_;
  core::Mixer mixer_;
};

TEST(Surfaces, AnInvertedVTailGivesAllOfWhatIsAskedFor) {
  Chain chain(load("anaconda"));
  // ROSflight 2.x's simulator recovers half: 20 degrees.
  EXPECT_NEAR(chain.settled(0, -1, 0).elevator_rad / kDegree, 40.0, 1e-4);
  EXPECT_NEAR(chain.settled(0, 0, -1).rudder_rad / kDegree, 40.0, 1e-4);
  EXPECT_NEAR(chain.settled(1, 0, 0).aileron_rad / kDegree, 40.0, 1e-4);
  const sim::Deflection both = chain.settled(0, 0.25F, -0.5F);
  EXPECT_NEAR(both.elevator_rad / kDegree, -10.0, 1e-4);
  EXPECT_NEAR(both.rudder_rad / kDegree, 20.0, 1e-4);
  EXPECT_NEAR(both.aileron_rad, 0.0, 1e-6);
}

TEST(Surfaces, PositiveEntriesRollRightPitchUpYawRightOnEveryVehicle) {
  for (const char* name : {"anaconda", "openvsp_anaconda", "xflr5_anaconda", "aerosonde"}) {
    SCOPED_TRACE(name);
    Chain chain(load(name));
    EXPECT_GT(chain.moment(0.5F, 0, 0).x(), 0.5);
    EXPECT_GT(chain.moment(0, 0.5F, 0).y(), 0.5);
    EXPECT_GT(chain.moment(0, 0, 0.5F).z(), 0.5);
  }
}

TEST(Surfaces, APlainTailThroughMixer9) {
  Chain chain(load("anaconda", {"firmware.PRIMARY_MIXER=9",
                                "surfaces.layout=[{output: 0, travel_deg: 40, aileron: 1}, "
                                "{output: 1, travel_deg: 30, elevator: 1}, "
                                "{output: 2, travel_deg: 20, rudder: 1}]"}));
  EXPECT_NEAR(chain.settled(0, -1, 0).elevator_rad / kDegree, 30.0, 1e-4);
  EXPECT_NEAR(chain.settled(0, 0, -1).rudder_rad / kDegree, 20.0, 1e-4);
}

TEST(Surfaces, ElevonsThroughACustomMixer) {
  // Left and right elevon: both down pitch down, left down and right up roll right.
  Chain chain(load("anaconda", {"surfaces.layout=[{output: 0, travel_deg: 30, aileron: 0.5, "
                                "elevator: 0.5}, {output: 1, travel_deg: 30, aileron: -0.5, "
                                "elevator: 0.5}]"}));
  core::MixerHeader header = core::frame_header(core::MixerId::kFixedWing);
  core::MixerGains gains = core::MixerGains::Zero();
  gains(0, 3) = 0.5F;  // channel 0: half of aileron and half of elevator
  gains(0, 4) = 0.5F;
  gains(1, 3) = -0.5F;
  gains(1, 4) = 0.5F;
  gains(4, 0) = 1.0F;
  chain.mixer().set_header(header);
  chain.mixer().primary() = chain.mixer().secondary() = gains;
  const sim::Deflection roll = chain.settled(1, 0, 0);
  EXPECT_NEAR(roll.aileron_rad / kDegree, 15.0, 1e-4);
  EXPECT_NEAR(roll.elevator_rad, 0.0, 1e-6);
  const sim::Deflection pitch = chain.settled(0, -1, 0);
  EXPECT_NEAR(pitch.elevator_rad / kDegree, 15.0, 1e-4);
  EXPECT_NEAR(pitch.aileron_rad, 0.0, 1e-6);
}

}  // namespace
}  // namespace rosflight::flight
