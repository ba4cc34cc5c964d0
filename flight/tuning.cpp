// SPDX-License-Identifier: BSD-3-Clause
#include "flight/tuning.hpp"

#include <fmt/format.h>

#include <utility>

#include "config/table.hpp"
#include "flight/vehicle/quadplane_setup.hpp"

namespace rosflight::flight {
namespace {

using config::Error;

TunedVehicle read(config::Document document) {
  const sim::Vehicle vehicle(std::move(document));
  if (is_quadplane(vehicle))
    throw Error("tune: found a quad-plane, allowed a multirotor or a fixed wing");
  if (is_fixed_wing(vehicle)) return {vehicle.text(), read_fixedwing_autonomy(vehicle)};
  return {vehicle.text(), read_multirotor_autonomy(vehicle)};
}

std::string written(const autonomy::multirotor::AutonomyConfig& config) {
  return autonomy::multirotor::parameters().write(config);
}
std::string written(const autonomy::fixedwing::AutonomyConfig& config) {
  return autonomy::fixedwing::parameters().write(config);
}

/// Only what is read as a mission is loaded differs.
template <class Config>
bool waits_for_a_mission(const Config& before, Config after) {
  if (written(after) == written(before)) return false;
  after.mission = before.mission;
  return written(after) == written(before);
}

}  // namespace

TunedVehicle tuned(const std::string& text, const FlightSetup& setup, const std::string& key,
                   const std::string& value) {
  if (value.empty())
    throw Error(fmt::format("tune {}: found no value, allowed KEY VALUE", key.substr(0, 60)));
  const auto open = [&] {
    return config::Document::from_text(text, "vehicle", setup.vehicle.root().directory());
  };
  if (key.starts_with("estimator.") || key == "estimator")
    throw Error(fmt::format("tune: found {}, allowed before a flight alone", key.substr(0, 60)));
  config::Document changed = open();
  changed.set("autonomy." + key + "=" + value, "tune");
  TunedVehicle after = read(std::move(changed));
  const TunedVehicle before = read(open());
  const bool waits = std::visit(
      [&before](const auto& config) {
        return waits_for_a_mission(std::get<std::decay_t<decltype(config)>>(before.autonomy),
                                   config);
      },
      after.autonomy);
  if (waits) throw Error(fmt::format("tune: found {}, allowed before a flight alone", key));
  return after;
}

}  // namespace rosflight::flight
