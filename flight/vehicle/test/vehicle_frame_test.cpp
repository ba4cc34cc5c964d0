// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "firmware/core/mixer_frames.hpp"
#include "flight/vehicle/frame.hpp"
#include "flight/vehicle/mixer_fault.hpp"
#include "flight/vehicle/vehicle_setup.hpp"

namespace rosflight::flight {
namespace {

using Values = std::map<std::string, double>;

sim::Vehicle vehicle(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return sim::Vehicle::from_file("vehicles/" + name + ".yaml", overrides);
}

Values firmware_of(const std::string& name, const std::vector<std::string>& overrides = {}) {
  Values values;
  for (const auto& entry : read_firmware_parameters(vehicle(name, overrides))) {
    EXPECT_TRUE(values.emplace(entry.name, entry.value.number()).second) << entry.name << " twice";
  }
  return values;
}

std::string refusal(const std::string& name, const std::vector<std::string>& overrides) {
  try {
    firmware_of(name, overrides);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "accepted";
}

const std::string kGeometry = "firmware.PRIMARY_MIXER=geometry";

TEST(VehicleFrame, MotorsAndPropellersOfBothKindsComeFromTheRotors) {
  for (const std::string name : {"multirotor", "anaconda"}) {
    const sim::MultirotorParameters rotors = read_rotors(vehicle(name));
    const Values values = firmware_of(name);
    EXPECT_EQ(values.at("NUM_MOTORS"), static_cast<double>(rotors.rotors.size()));
    EXPECT_FLOAT_EQ(static_cast<float>(values.at("PROP_CT")),
                    static_cast<float>(rotors.propeller.thrust[0]));
    EXPECT_FLOAT_EQ(static_cast<float>(values.at("MOTOR_RESISTANCE")),
                    static_cast<float>(rotors.motor.resistance_ohm));
  }
  EXPECT_DOUBLE_EQ(firmware_of("multirotor", {"firmware.NUM_MOTORS=3"}).at("NUM_MOTORS"), 3.0)
      << "what the section gives is what the firmware gets";
}

// Motors of the predefined mixers: docs/predefined-mixers.md.
TEST(MixerFault, NamesAMixerOfOtherMotorsThanTheVehicles) {
  for (const auto& [id, motors] :
       {std::pair{1, 4}, {2, 4}, {3, 6}, {4, 6}, {5, 8}, {6, 8}, {7, 6}, {8, 8}, {0, 10}}) {
    for (const std::size_t rotors : {4U, 6U, 8U, 10U}) {
      const std::string fault = mixer_fault(id, rotors);
      EXPECT_EQ(fault.empty(), static_cast<int>(rotors) == motors) << id << ' ' << fault;
      const std::string said =
          fmt::format("PRIMARY_MIXER: found {}, that of {} motors", id, motors);
      EXPECT_TRUE(fault.empty() || fault.starts_with(said)) << fault;
    }
  }
  for (const int surfaces : {9, 10})
    EXPECT_NE(mixer_fault(surfaces, 1).find("a fixed wing's"), std::string::npos);
  for (const int other : {-1, 11, 12, 255}) EXPECT_EQ(mixer_fault(other, 4), "") << other;
}

// The layout of the default vehicle is a quadrotor X: up to one factor for each axis its gains are
// those of the predefined mixer.
TEST(VehicleFrame, GeometryOfAQuadrotorXHasTheGainsOfThePredefinedMixer) {
  const Values values = firmware_of("multirotor", {kGeometry});
  EXPECT_EQ(values.at("PRIMARY_MIXER"), 11.0);
  EXPECT_EQ(values.at("USE_MOTOR_PARAM"), 1.0);
  const core::MixerGains known = core::frame_gains(core::MixerId::kQuadX);
  for (int axis = 2; axis < 6; ++axis) {
    const auto gain = [&](int channel) {
      return values.at("PRI_MIXER_" + std::to_string(axis) + "_" + std::to_string(channel));
    };
    const double factor = gain(0) / static_cast<double>(known(0, axis));
    EXPECT_GT(factor, 0.0);
    for (int channel = 0; channel < 10; ++channel) {
      EXPECT_NEAR(gain(channel), factor * static_cast<double>(known(channel, axis)), 1e-4 * factor)
          << axis << ' ' << channel;
    }
  }
}

// Columns of the matrix of forces and torques times the gains are the identity, by hand: one newton
// metre of roll is shared by four arms of 0.1768 m, each rotor of thrust gain kT.
TEST(VehicleFrame, GainsAreInNewtonMetres) {
  const Values values = firmware_of("multirotor", {kGeometry});
  const FrameConfig frame = vehicle_frame(vehicle("multirotor"));
  const double kt = frame.thrust_gain_N_s2();
  EXPECT_NEAR(values.at("PRI_MIXER_3_0"), -1.0 / (4.0 * 0.1768 * kt), 0.1);
  EXPECT_NEAR(values.at("PRI_MIXER_4_0"), 1.0 / (4.0 * 0.1768 * kt), 0.1);
  EXPECT_NEAR(values.at("PRI_MIXER_2_0"), -1.0 / (4.0 * kt), 0.1);
  // US Standard Atmosphere 1976 at 1387 m: 1.225 (279.13/288.15)^4.2559 kg/m^3.
  EXPECT_NEAR(frame.air_density_kg_m3, 1.0700, 1e-4);
  EXPECT_DOUBLE_EQ(frame.max_voltage_V, 25.2) << "BATT_VOLT_MAX of the file";
}

struct Predefined {
  const char* vehicle;
  core::MixerId id;
};
constexpr Predefined kPredefined[]{{"quad_plus", core::MixerId::kQuadPlus},
                                   {"multirotor", core::MixerId::kQuadX},
                                   {"hexa_plus", core::MixerId::kHexPlus},
                                   {"hexarotor", core::MixerId::kHexX},
                                   {"octo_plus", core::MixerId::kOctoPlus},
                                   {"octorotor", core::MixerId::kOctoX},
                                   {"y6", core::MixerId::kY6},
                                   {"x8", core::MixerId::kX8}};

// The rule behind the tables (ROSflight 2.0 paper): a motor at angle theta with spin d adds
// [0, 0, -1/n, -sin theta, cos theta, d] to force and torque. The tables have four decimals.
TEST(VehicleFrame, RotorsAreWhereThePredefinedMixerHasThem) {
  for (const Predefined& frame : kPredefined) {
    SCOPED_TRACE(frame.vehicle);
    const Values values = firmware_of(frame.vehicle);
    EXPECT_EQ(values.at("PRIMARY_MIXER"), static_cast<double>(frame.id));
    for (const auto& entry : values)
      EXPECT_FALSE(entry.first.starts_with("PRI_MIXER_")) << entry.first;
    const auto rotors = read_rotors(vehicle(frame.vehicle)).rotors;
    EXPECT_EQ(mixer_fault(static_cast<int>(frame.id), rotors.size()), "");
    Eigen::Matrix<float, core::kAxes, core::kChannels> M;
    M.setZero();
    for (const sim::RotorParameters& rotor : rotors) {
      const double arm_m = std::hypot(rotor.p_B.x(), rotor.p_B.y());
      const auto k = static_cast<Eigen::Index>(rotor.output);
      M(2, k) = -1.0F / static_cast<float>(rotors.size());
      M(3, k) = static_cast<float>(-rotor.p_B.y() / arm_m);
      M(4, k) = static_cast<float>(rotor.p_B.x() / arm_m);
      M(5, k) = static_cast<float>(-rotor.spin);  // up: the drag turns the nose by -spin
    }
    EXPECT_LT((core::pseudo_inverse(M) - core::frame_gains(frame.id)).cwiseAbs().maxCoeff(), 3e-4F);
  }
}

// vehicles/README.md: a hub of 2.5 kg, which with four arms is the default quadrotor, and 0.25 kg at
// the end of each arm.
TEST(VehicleFrame, MassAndInertiaFollowFromTheDefaultQuadrotor) {
  constexpr double kArm_kg = 0.25;
  const auto arms = [&](const char* name) {
    sim::Matrix3 J = sim::Matrix3::Zero();
    for (const sim::RotorParameters& rotor : read_rotors(vehicle(name)).rotors) {
      J += kArm_kg *
           (rotor.p_B.squaredNorm() * sim::Matrix3::Identity() - rotor.p_B * rotor.p_B.transpose());
    }
    return J;
  };
  const sim::Matrix3 hub = vehicle("multirotor").body().inertia_kg_m2 - arms("multirotor");
  for (const char* name :
       {"quad_plus", "hexa_plus", "hexarotor", "octo_plus", "octorotor", "y6", "x8", "tricopter"}) {
    SCOPED_TRACE(name);
    const sim::BodyParameters body = vehicle(name).body();
    const auto count = static_cast<double>(read_rotors(vehicle(name)).rotors.size());
    EXPECT_NEAR(body.mass_kg, 2.5 + kArm_kg * count, 1e-9);
    EXPECT_LT((body.inertia_kg_m2 - hub - arms(name)).cwiseAbs().maxCoeff(), 1e-4);
  }
}

// docs/mixer.md: P = J w^2/u, D = 2 z w J/u with w = 10 rad/s, z = 0.7; u = arm x dF/dthrottle, since the
// rows of a predefined mixer have arms of 1.
TEST(VehicleFrame, AttitudeGainsFollowFromInertiaAndArm) {
  for (const char* name :
       {"quad_plus", "hexa_plus", "hexarotor", "octo_plus", "octorotor", "y6", "x8", "tricopter"}) {
    SCOPED_TRACE(name);
    const sim::Vehicle file = vehicle(name);
    const FrameConfig frame = propulsion_frame(file);
    const double W = hover_check(frame).speed_rad_s;
    const double dV_dW = frame.motor_kv_V_s_rad + 2.0 * W * frame.motor_resistance_ohm *
                                                      frame.torque_gain_Nm_s2() /
                                                      frame.motor_kv_V_s_rad;
    const double unit_Nm = std::hypot(frame.rotors[0].p_B.x(), frame.rotors[0].p_B.y()) * 2.0 *
                           frame.thrust_gain_N_s2() * W * frame.max_voltage_V / dV_dW;
    const Values values = firmware_of(name);
    const double J = file.body().inertia_kg_m2(0, 0);
    // Up to the battery's sag, and the quadrotor's rounding of 0.94 to 1.
    EXPECT_NEAR(values.at("PID_ROLL_ANG_P"), J * 100.0 / unit_Nm, 0.1 * J * 100.0 / unit_Nm);
    EXPECT_NEAR(values.at("PID_ROLL_ANG_D"), J * 14.0 / unit_Nm, 0.1 * J * 14.0 / unit_Nm);
    EXPECT_EQ(values.at("PID_ROLL_ANG_I"), values.at("PID_ROLL_ANG_P"));
    EXPECT_EQ(values.at("PID_PITCH_ANG_P"), values.at("PID_ROLL_ANG_P"));
  }
}

// docs/mixer.md, units of the attitude gains: newton metres of roll for one unit of a predefined
// mixer, from the slope of thrust over throttle at hover.
TEST(VehicleFrame, UnitOfThePredefinedMixerIsThatOfTheDocument) {
  const FrameConfig frame = vehicle_frame(vehicle("multirotor"));
  const double W = hover_check(frame).speed_rad_s;
  const double dV_dW = frame.motor_kv_V_s_rad + 2.0 * W * frame.motor_resistance_ohm *
                                                    frame.torque_gain_Nm_s2() /
                                                    frame.motor_kv_V_s_rad;
  const double dF_dthrottle = 2.0 * frame.thrust_gain_N_s2() * W * frame.max_voltage_V / dV_dW;
  const core::MixerGains gains = core::frame_gains(core::MixerId::kQuadX);
  double unit_Nm = 0.0;
  for (const FrameRotor& rotor : frame.rotors) {
    unit_Nm -= rotor.p_B.y() * dF_dthrottle *
               static_cast<double>(gains(static_cast<Eigen::Index>(rotor.output), 3));
  }
  EXPECT_NEAR(unit_Nm, 8.7, 0.05);
}

TEST(VehicleFrame, AGainFollowsTheOutputOfItsRotor) {
  const Values as_is = firmware_of("multirotor", {kGeometry});
  const std::string layout =
      "rotors.layout=[{output: 7, position_m: [0.1768, 0.1768, -0.0762], thrust_direction: [0, 0, "
      "-1], spin: -1}, "
      "{output: 1, position_m: [-0.1768, 0.1768, -0.0762], thrust_direction: [0, 0, -1], spin: 1}, "
      "{output: 2, position_m: [-0.1768, -0.1768, -0.0762], thrust_direction: [0, 0, -1], spin: "
      "-1}, "
      "{output: 3, position_m: [0.1768, -0.1768, -0.0762], thrust_direction: [0, 0, -1], spin: 1}]";
  const Values moved = firmware_of("multirotor", {kGeometry, layout});
  EXPECT_EQ(moved.at("PRI_MIXER_3_7"), as_is.at("PRI_MIXER_3_0"));
  EXPECT_EQ(moved.at("PRI_MIXER_OUT_7"), 2.0);
  EXPECT_EQ(moved.at("PRI_MIXER_3_0"), 0.0);
  EXPECT_EQ(moved.at("PRI_MIXER_OUT_0"), 0.0);
}

TEST(VehicleFrame, WhatGeometryDecidesIsRefusedInTheSection) {
  EXPECT_NE(refusal("multirotor", {kGeometry, "firmware.PRI_MIXER_2_0=1"}).find("PRI_MIXER_2_0"),
            std::string::npos);
  EXPECT_NE(refusal("multirotor", {kGeometry, "firmware.USE_MOTOR_PARAM=0"}).find("computes it"),
            std::string::npos);
  EXPECT_NE(refusal("anaconda", {kGeometry}).find("found fixedwing, allowed a multirotor"),
            std::string::npos);
  EXPECT_NE(refusal("multirotor", {"firmware.PRIMARY_MIXER=geometric"}).find("geometric"),
            std::string::npos);
  const std::string line =
      "rotors.layout=[{output: 0, position_m: [0.2, 0, 0], thrust_direction: [0, 0, -1], spin: "
      "-1}, "
      "{output: 1, position_m: [0.1, 0, 0], thrust_direction: [0, 0, -1], spin: 1}, "
      "{output: 2, position_m: [-0.1, 0, 0], thrust_direction: [0, 0, -1], spin: -1}, "
      "{output: 3, position_m: [-0.2, 0, 0], thrust_direction: [0, 0, -1], spin: 1}]";
  EXPECT_NE(refusal("multirotor", {kGeometry, line}).find("independently"), std::string::npos);
}

}  // namespace
}  // namespace rosflight::flight
