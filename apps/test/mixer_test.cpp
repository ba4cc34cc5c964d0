// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "apps/mixer_command.hpp"
#include "companion/parameter_file.hpp"
#include "config/strict_yaml.hpp"
#include "firmware/core/parameters.hpp"
#include "flight/vehicle/frame.hpp"

namespace rosflight::flight {
namespace {

namespace fs = std::filesystem;

const char* const kShipped = "apps/test/x650_frame.yaml";

std::string shipped_text() {
  std::ifstream file(kShipped);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Mixer : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("rosflight_mixer_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// The shipped frame with one text replaced.
  std::string edited(const std::string& from, const std::string& to) {
    std::string text = shipped_text();
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const fs::path file = folder_ / "frame.yaml";
    std::ofstream(file) << text;
    return file.string();
  }
  void refuses(const std::string& from, const std::string& to, const std::string& part) {
    try {
      static_cast<void>(read_frame(edited(from, to)));
      FAIL() << "was accepted: " << to;
    } catch (const config::Error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }

  fs::path folder_;
};

float value_of(const companion::ParameterSet& set, const std::string& name) {
  for (const auto& entry : set) {
    if (entry.name == name) return static_cast<float>(entry.value.number());
  }
  ADD_FAILURE() << name << " is missing";
  return 0.0F;
}

// Numbers of the frame file that ROSflight 2.0's autonomy ships, worked out from the equations.
TEST_F(Mixer, ShippedFrameGivesTheKnownGains) {
  const FrameConfig frame = read_frame(kShipped);
  EXPECT_NEAR(frame.thrust_gain_N_s2(), 4.299379e-5, 1e-11);
  EXPECT_NEAR(frame.torque_gain_Nm_s2(), 9.360986e-7, 1e-13);
  const auto set = mixer_parameters(frame, MixerTarget::kPrimary);
  constexpr float kFz = 5814.7935F;
  constexpr float kQxy = 25303.7142F;
  constexpr float kQz = 267065.8876F;
  const int signs[4][4] = {{-1, -1, 1, 1}, {-1, -1, -1, -1}, {-1, 1, -1, 1}, {-1, 1, 1, -1}};
  for (int k = 0; k < 4; ++k) {
    const auto gain = [&](int input) {
      return value_of(set, "PRI_MIXER_" + std::to_string(input) + "_" + std::to_string(k));
    };
    const auto sign = [&](int column) { return static_cast<float>(signs[k][column]); };
    EXPECT_NEAR(gain(2), sign(0) * kFz, 1e-2F);
    EXPECT_NEAR(gain(3), sign(1) * kQxy, 1e-1F);
    EXPECT_NEAR(gain(4), sign(2) * kQxy, 1e-1F);
    EXPECT_NEAR(gain(5), sign(3) * kQz, 1.0F);
    EXPECT_EQ(gain(0), 0.0F);
    EXPECT_EQ(gain(9), 0.0F);
  }
  EXPECT_EQ(value_of(set, "PRI_MIXER_OUT_3"), 2.0F);
  EXPECT_EQ(value_of(set, "PRI_MIXER_OUT_4"), 0.0F);
  EXPECT_EQ(value_of(set, "PRI_MIXER_2_7"), 0.0F);
}

TEST_F(Mixer, HoverCheckAgreesWithTheHandCalculation) {
  const HoverCheck check = hover_check(read_frame(kShipped));
  EXPECT_NEAR(check.speed_rad_s, 471.67, 0.1);
  EXPECT_NEAR(check.voltage_V, 14.35, 0.01);
  EXPECT_NEAR(check.throttle, 0.611, 0.001);
  EXPECT_NEAR(check.max_speed_rad_s, 754.9, 0.1);
  EXPECT_NEAR(check.max_thrust_N, 98.0, 0.1);
  EXPECT_NEAR(check.thrust_to_weight, 2.56, 0.01);
}

// In single precision, as the firmware stores the gains.
TEST_F(Mixer, InverseOfATiltedHexacopterIsExact) {
  FrameConfig frame = read_frame(kShipped);
  frame.rotors.clear();
  for (int k = 0; k < 6; ++k) {
    const double angle = k * 1.0471975511965976;
    const double tilt = (k % 2 == 0 ? 1 : -1) * 0.3;
    FrameRotor rotor;
    rotor.p_B = {0.3 * std::cos(angle), 0.3 * std::sin(angle), 0.0};
    rotor.e_B = {-std::sin(angle) * std::sin(tilt), std::cos(angle) * std::sin(tilt),
                 -std::cos(tilt)};
    rotor.spin = k % 2 == 0 ? 1 : -1;
    frame.rotors.push_back(rotor);
  }
  const Eigen::MatrixXd M = frame_matrix(frame);
  EXPECT_EQ(frame_quality(frame, M).rank, 6);
  EXPECT_LT((M * frame_inverse(M) - Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(Mixer, EveryParameterIsKnownToTheFirmwareAndInRange) {
  for (const MixerTarget target : {MixerTarget::kPrimary, MixerTarget::kSecondary}) {
    for (const auto& entry : mixer_parameters(read_frame(kShipped), target)) {
      const std::size_t index = core::Parameters::find(core::padded_name(entry.name.c_str()));
      ASSERT_LT(index, core::kParamCount) << entry.name;
      const auto id = static_cast<core::Param>(index);
      ASSERT_EQ(core::Parameters::row(id).type, entry.value.type) << entry.name;
      const core::ParamValue value = entry.value.type == link::ParamType::kInt32
                                         ? core::ParamValue{entry.value.as_int32()}
                                         : core::ParamValue{entry.value.as_float()};
      EXPECT_TRUE(core::Parameters::in_range(id, value)) << entry.name;
    }
  }
}

TEST_F(Mixer, CommandWritesAFileThatReadsBackAndKeepsAnOldOne) {
  apps::MixerOptions options;
  options.input = kShipped;
  options.output = (folder_ / "out.yaml").string();
  std::ostringstream out;
  EXPECT_EQ(apps::mixer_command(options, out), 0);
  EXPECT_NE(out.str().find("thrust to weight 2.56"), std::string::npos) << out.str();
  const auto primary = companion::read_parameter_file(options.output);
  EXPECT_EQ(primary.size(), 130U);
  EXPECT_THROW(apps::mixer_command(options, out), config::Error) << "the file exists";
  options.append = true;
  options.target = MixerTarget::kSecondary;
  EXPECT_EQ(apps::mixer_command(options, out), 0);
  EXPECT_EQ(companion::read_parameter_file(options.output).size(), 130U + 101U);
}

TEST_F(Mixer, BadFramesAreRefused) {
  refuses("num_motors: 4", "num_motors: 11", "num_motors");
  refuses("num_motors: 4", "num_motors: 6", "motor_positions");
  refuses("motor_directions: [-1, 1, -1, 1]", "motor_directions: [-1, 1, 0.5, 1]", "-1 or 1");
  refuses("motor_orientations: [0.0, 0.0, -1.0", "motor_orientations: [0.0, 0.1, -1.0",
          "unit vectors");
  refuses(
      "motor_positions: [0.2298, 0.2298, 0.0,  -0.2298, 0.2298, 0.0,  -0.2298, -0.2298, 0.0,  "
      "0.2298, -0.2298, 0.0]",
      "motor_positions: [0.2, 0, 0, 0.1, 0, 0, -0.1, 0, 0, -0.2, 0, 0]", "independently");
  refuses("prop_ct: 0.075", "prop_ct: -1", "prop_ct");
  refuses("prop_ct: 0.075", "prop_cut: 0.075", "prop_c");
  EXPECT_THROW(static_cast<void>(read_frame((folder_ / "none.yaml").string())), config::Error);
}

}  // namespace
}  // namespace rosflight::flight
