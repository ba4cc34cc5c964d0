// SPDX-License-Identifier: BSD-3-Clause
#include "apps/trim_command.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "config/strict_yaml.hpp"

namespace rosflight::apps {
namespace {

TrimOptions at(const std::string& vehicle, double speed_m_s) {
  TrimOptions options;
  options.vehicle = vehicle;
  options.speed_m_s = speed_m_s;
  return options;
}

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
  EXPECT_EQ(trim_command(at("anaconda", 17.0), out), 0);
  for (const char* word : {"angle of attack", "throttle", "left over", "short period", "phugoid",
                           "Dutch roll", "roll", "spiral", "(Lanchester)", "of Lanchester's"})
    EXPECT_NE(out.str().find(word), std::string::npos) << word;
}

TEST(TrimCommand, ShowsThePublishedLevelFlightOfTheReference) {
  std::ostringstream out;
  TrimOptions options = at("anaconda", 15.0);
  options.overrides = {"rotors.motor.model=instant",
                       "rotors.flow=airspeed",
                       "battery.model=constant",
                       "battery.constant_voltage_V=24",
                       "vehicle.aero.model=reference",
                       "environment.gravity_m_s2=9.81",
                       "environment.atmosphere.model=constant",
                       "environment.atmosphere.density_kg_m3=1.2682"};
  trim_command(options, out);
  // 0.77 degrees, 4.36 N, throttle 0.506, rounded.
  EXPECT_NE(out.str().find("angle of attack           0.769"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("thrust                    4.355"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("throttle                  0.5059"), std::string::npos) << out.str();
}

TEST(TrimCommand, RefusesInOneLine) {
  EXPECT_EQ(message_of(at("anaconda", 0.0)), "--speed: found 0, allowed a number > 0 and <= 200");
  EXPECT_EQ(message_of(at("multirotor", 15.0)),
            "--vehicle: found multirotor of type multirotor, allowed one of type fixedwing");
  EXPECT_EQ(
      message_of(at("anaconda", 33.0)),
      "--speed: found 33, allowed what anaconda can hold: this needs more than full throttle");
  EXPECT_EQ(message_of(at("anaconda", 7.0)),
            "--speed: found 7, allowed what anaconda can hold: this needs more lift than the wing "
            "has");
  EXPECT_NE(message_of(at("kite", 7.0)).find("vehicle: found kite, allowed"), std::string::npos);
  TrimOptions turning = at("anaconda", 15.0);
  for (const double radius : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    turning.radius_m = radius;
    EXPECT_NE(message_of(turning).find("allowed 1 to 1000000 m, right turns positive"),
              std::string::npos);
  }
  TrimOptions climbing = at("anaconda", 15.0);
  climbing.climb_deg = 90.0;
  EXPECT_EQ(message_of(climbing), "--climb: found 90, allowed a number from -60 to 60");
  TrimOptions misspelt = at("anaconda", 15.0);
  misspelt.overrides = {"vehicle.body.mas_kg=4"};
  EXPECT_NE(message_of(misspelt).find("body.mas_kg: found"), std::string::npos);
}

}  // namespace
}  // namespace rosflight::apps
