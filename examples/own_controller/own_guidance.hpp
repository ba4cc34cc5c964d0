// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <variant>

#include "config/strict_yaml.hpp"
#include "flight/flight_setup.hpp"
#include "flight/guidance.hpp"
#include "geometric_controller.hpp"

namespace own_controller {

/// The project's guidance with this folder's controller in it.
inline std::unique_ptr<rosflight::flight::Guidance> own_guidance(
    const rosflight::flight::FlightSetup& setup) {
  const auto* plan = std::get_if<rosflight::flight::MultirotorPlan>(&setup.plan);
  if (plan == nullptr) {
    throw rosflight::config::Error("own_controller: found a fixed wing, allowed a multirotor");
  }
  const rosflight::autonomy::multirotor::FlightConfig& flight = plan->autonomy.flight;
  GeometricConfig config;
  config.mass_kg = flight.follower.mass_kg;
  config.gravity_m_s2 = flight.follower.gravity_m_s2;
  config.drag_1_s = flight.follower.drag_1_s;
  return std::make_unique<rosflight::flight::MultirotorGuidance>(
      flight, plan->mission, std::make_unique<GeometricController>(config));
}

}  // namespace own_controller
