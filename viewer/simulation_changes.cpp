// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/simulation_changes.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "config/strict_yaml.hpp"
#include "flight/steering.hpp"

namespace rosflight::viewer {
namespace {

double number_in(const std::string& what, const std::string& text, double low, double high) {
  const auto number = config::parse_number(text);
  if (number && *number >= low && *number <= high) return *number;
  throw config::Error(what + ": found '" + text + "', allowed " + config::number_text(low) +
                      " to " + config::number_text(high));
}

}  // namespace

std::optional<std::string> parse_reset(const std::string& text, flight::FlightChoice choice) {
  constexpr std::string_view kVerb = "reset";
  if (text == kVerb) return std::string();
  if (!text.starts_with("reset ")) return std::nullopt;
  choice.mission = text.substr(kVerb.size() + 1);
  static_cast<void>(flight::FlightSetup(choice));
  return choice.mission;
}

std::function<void()> parse_simulation_change(const std::string& text, flight::Flight& flight,
                                              Pace& pace) {
  const std::size_t space = std::min(text.find(' '), text.size());
  const std::string verb = text.substr(0, space);
  const std::string rest = space < text.size() ? text.substr(space + 1) : "";
  if (text == "pause") return [&pace] { pace.paused = true; };
  if (text == "resume") return [&pace] { pace.paused = false; };
  if (verb == "step") {
    constexpr double kMaxSteps = 4000.0;  // 10 s
    const double count = number_in("step", rest, 1.0, kMaxSteps);
    if (count != std::floor(count))
      throw config::Error("step: found " + rest + ", allowed 1, 2, ...");
    return [&pace, count] {
      pace.paused = true;
      pace.steps = static_cast<int>(count);
    };
  }
  if (verb == "speed") {
    constexpr double kMinSpeed = 0.01;
    constexpr double kMaxSpeed = 100.0;
    return [&pace, speed = number_in("speed", rest, kMinSpeed, kMaxSpeed)] { pace.speed = speed; };
  }
  if (const auto mission = parse_reset(text, flight.setup().choice))
    return [&pace, mission] { pace.reset = mission; };
  return [&flight, change = flight::parse_change(text, flight)] { change(flight); };
}

}  // namespace rosflight::viewer
