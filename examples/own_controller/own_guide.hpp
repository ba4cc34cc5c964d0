// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <variant>

#include "apps/fly/flight_setup.hpp"
#include "apps/fly/guide.hpp"
#include "config/strict_yaml.hpp"
#include "examples/own_controller/geometric_controller.hpp"

namespace own_controller {

/// The project's guidance with this folder's controller in it.
inline std::unique_ptr<rosflight::apps::Guide> own_guide(
    const rosflight::apps::FlightSetup& setup) {
  const auto* plan = std::get_if<rosflight::apps::MultirotorPlan>(&setup.plan);
  if (plan == nullptr) {
    throw rosflight::config::Error("own_controller: found a fixed wing, allowed a multirotor");
  }
  const rosflight::autonomy::FlightConfig& flight = plan->autonomy.flight;
  GeometricConfig config;
  config.mass_kg = flight.follower.mass_kg;
  config.gravity_m_s2 = flight.follower.gravity_m_s2;
  config.drag_1_s = flight.follower.drag_1_s;
  return std::make_unique<rosflight::apps::MultirotorGuide>(
      flight, plan->mission, std::make_unique<GeometricController>(config));
}

}  // namespace own_controller
