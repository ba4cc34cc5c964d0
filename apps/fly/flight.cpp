// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/flight.hpp"

#include <algorithm>

namespace rosflight::apps {
namespace {

sim::rc::Script pilot_script(const FlightSetup& setup) {
  sim::rc::Script script;
  script.channels = setup.channels;
  return script;
}

DirectorConfig director_config(const FlightSetup& setup) {
  DirectorConfig config;
  config.firmware = setup.firmware;
  config.step = Flight::kStep;
  config.on_truth = setup.choice.state == "truth";
  config.hover_stick = setup.autonomy.flight.thrust.throttle(
      setup.vehicle.body().mass_kg * setup.vehicle.environment().gravity_m_s2);
  return config;
}

}  // namespace

Flight::Flight(const FlightSetup& setup)
    : setup_{setup},
      random_{setup.choice.seed},
      forces_{setup.registry.make_forces(setup.vehicle, random_)},
      dynamics_{setup.vehicle.body(), setup.vehicle.ground(), setup.vehicle.environment(), *forces_,
                random_},
      healthy_sensors_{sim::sensors::make_sensors(setup.registry, setup.vehicle, random_)},
      sensors_{*healthy_sensors_, setup.faults},
      pilot_{pilot_script(setup)},
      rc_{pilot_, setup.faults},
      cable_{sim::SerialLine::Config{}, random_},
      board_end_{cable_, wire_time_},
      companion_end_{cable_, wire_time_},
      board_{board_end_},
      codec_{{1, link::MavlinkCodec::kCompanionComponent}},
      session_{codec_, companion_end_, companion::Session::Options{}},
      manager_{setup.autonomy.flight, setup.mission},
      navigator_{session_, setup.estimator},
      director_{director_config(setup), session_, pilot_, manager_, navigator_},
      fast_{kStep},
      loop_{time_, rc_, sensors_, board_slot_, dynamics_} {
  time_.source = &fast_;
  board_slot_.board = &board_;
  loop_.set_listener(this);
  const auto& faults = setup.faults.faults();
  motor_faults_ = std::any_of(faults.begin(), faults.end(), [](const sim::Fault& fault) {
    return fault.kind == sim::FaultKind::kMotor;
  });
  for (const std::string& name : setup.choice.visualisers) {
    visualisers_.push_back(setup.registry.visualisers.at(name)(setup.vehicle, random_));
    loop_.add(*visualisers_.back());
  }
  instruments_ = dynamic_cast<const sim::sensors::StandardSensors*>(healthy_sensors_.get());
  board_.start(loop_.now());
}

void Flight::set_tap(LinkTap* tap) {
  board_end_.set_tap(tap);
  companion_end_.set_tap(tap);
}

double Flight::firmware_hover_output() const {
  const double weight_N = setup_.vehicle.body().mass_kg * setup_.vehicle.environment().gravity_m_s2;
  return setup_.autonomy.flight.thrust.throttle(weight_N) *
         firmware_value(setup_.firmware, "RC_MAX_THR");
}

void Flight::before_step(sim::Time t) {
  wire_time_ = t;
  apply_faults(t);
  director_.step(t, dynamics_.truth());
  const autonomy::FlightOutput& output = manager_.output();
  if (output.tracking && director_.stage() == Stage::kFly) {
    tracking_.add((dynamics_.truth().body.p_N - output.setpoint.p_N).norm());
    own_tracking_.add((seen_position_N() - output.setpoint.p_N).head<2>().norm());
  }
  if (script_) script_(*this, t);
}

sim::Vector3 Flight::seen_position_N() const {
  const sim::Vector3& p_N = dynamics_.truth().body.p_N;
  const auto& origin = navigator_.estimator().origin();
  if (setup_.choice.state == "truth" || !origin || instruments_ == nullptr) return p_N;
  const sim::GeodeticPosition& home = setup_.vehicle.environment().origin;
  const sim::Vector3 origin_N =
      autonomy::ned_of(*origin, {home.latitude_deg, home.longitude_deg, home.height_m});
  return p_N + instruments_->gnss_bias() - origin_N;
}

void Flight::apply_faults(sim::Time t) {
  const bool cut = setup_.faults.active(sim::FaultKind::kLinkCut, t);
  if (cut != cable_.to_board.cut()) {
    cable_.advance(t);
    cable_.set_cut(cut);
  }
  if (!motor_faults_) return;
  for (std::size_t k = 0; k < setup_.rotors.rotors.size(); ++k) {
    forces_->set_thrust_factor(k, setup_.faults.thrust_factor(k, t));
  }
}

}  // namespace rosflight::apps
