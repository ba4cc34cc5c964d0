// SPDX-License-Identifier: BSD-3-Clause
#include "apps/trim/trim_command.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "config/strict_yaml.hpp"

namespace rosflight::apps {
namespace {

std::string message_of(const TrimOptions& options) {
  std::ostringstream out;
  try {
    trim_command(options, out);
  } catch (const config::Error& error) {
    EXPECT_TRUE(out.str().empty());  // nothing half-written
    return error.what();
  }
  return "no error";
}

TEST(TrimCommand, PrintsTrimModesAndLanchester) {
  std::ostringstream out;
  EXPECT_EQ(trim_command({.vehicle = "anaconda", .speed_m_s = 17.0}, out), 0);
  for (const char* word : {"angle of attack", "throttle", "short period", "phugoid", "Dutch roll",
                           "spiral", "(Lanchester)", "of Lanchester's"})
    EXPECT_NE(out.str().find(word), std::string::npos) << word;
}

TEST(TrimCommand, ShowsThePublishedLevelFlightOfTheReference) {
  std::ostringstream out;
  const TrimOptions options{
      .vehicle = "anaconda",
      .speed_m_s = 15.0,
      .overrides = {"rotors.motor.model=instant", "rotors.flow=airspeed", "battery.model=constant",
                    "battery.constant_voltage_V=24", "aero.model=reference",
                    "environment.gravity_m_s2=9.81", "environment.atmosphere.model=constant",
                    "environment.atmosphere.density_kg_m3=1.2682"}};
  trim_command(options, out);
  EXPECT_NE(out.str().find("angle of attack           0.76"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("thrust                    4.35"), std::string::npos) << out.str();
}

TEST(TrimCommand, RefusesInOneLine) {
  EXPECT_EQ(message_of({.vehicle = "anaconda", .speed_m_s = 0.0}),
            "--speed: found 0, allowed a number > 0 and <= 200");
  EXPECT_EQ(message_of({.vehicle = "anaconda", .speed_m_s = 15.0, .radius_m = 0.0}),
            "--radius: found 0, allowed 1 to 1000000 m, right turns positive, left ones negative");
  EXPECT_EQ(message_of({.vehicle = "anaconda", .speed_m_s = 15.0, .climb_deg = 90.0}),
            "--climb: found 90, allowed a number from -60 to 60");
  EXPECT_EQ(message_of({.vehicle = "multirotor", .speed_m_s = 15.0}),
            "--vehicle: found multirotor of type multirotor, allowed one of type fixedwing");
  EXPECT_EQ(message_of({.vehicle = "anaconda", .speed_m_s = 60.0}),
            "--speed: found 60, allowed what anaconda can hold: this needs more thrust, lift or "
            "deflection than it has");
  EXPECT_EQ(message_of({.vehicle = "anaconda", .speed_m_s = 7.0}),
            "--speed: found 7, allowed what anaconda can hold: this needs more lift than the wing "
            "has");
  EXPECT_NE(message_of({.vehicle = "kite", .speed_m_s = 7.0}).find("vehicle: found kite, allowed"),
            std::string::npos);
}

}  // namespace
}  // namespace rosflight::apps
