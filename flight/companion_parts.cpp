// SPDX-License-Identifier: BSD-3-Clause
#include "flight/companion_parts.hpp"

namespace rosflight::flight {

MissionRunnerConfig runner_config(const FlightSetup& setup) {
  MissionRunnerConfig config;
  config.firmware = setup.firmware;
  config.on_truth = setup.choice.state == "truth";
  config.share_attitude = setup.estimator.share_attitude;
  config.pilot_stick = setup.choice.pilot == "idle" ? 0.0 : setup.hover_throttle;
  config.calibrate_airspeed = setup.winged();
  return config;
}

std::unique_ptr<LinkStateEstimator> make_link_estimator(const FlightSetup& setup,
                                                        companion::Session& session) {
  using autonomy::estimation::Airframe;
  const Airframe airframe = setup.winged() ? Airframe::kFixedWing : Airframe::kMultirotor;
  return std::make_unique<LinkStateEstimator>(session, setup.estimator, airframe);
}

}  // namespace rosflight::flight
