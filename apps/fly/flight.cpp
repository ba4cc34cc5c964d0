// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/flight.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/fly/emulated_board.hpp"
#include "apps/fly/uart_board.hpp"

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
  config.share_attitude = setup.estimator.share_attitude;
  config.hover_stick = setup.hover_throttle;
  config.calibrate_airspeed = setup.fixed_wing();
  return config;
}

std::unique_ptr<Guide> make_guide(const FlightSetup& setup) {
  if (const auto* wing = std::get_if<WingPlan>(&setup.plan)) {
    return std::make_unique<FixedWingGuide>(wing->autonomy.flight, wing->mission);
  }
  const auto& rotors = std::get<MultirotorPlan>(setup.plan);
  return std::make_unique<MultirotorGuide>(rotors.autonomy.flight, rotors.mission);
}

std::unique_ptr<Navigator> make_navigator(const FlightSetup& setup, companion::Session& session) {
  if (setup.fixed_wing()) return std::make_unique<LinkNavigator<true>>(session, setup.estimator);
  return std::make_unique<LinkNavigator<false>>(session, setup.estimator);
}

/// Nothing for the board in this process.
std::unique_ptr<FlightBoard> make_other_board(const FlightSetup& setup, sim::SerialCable& cable,
                                              BoardEnd& end, const sim::Time& clock) {
  if (setup.choice.board != "qemu_m7") return nullptr;
  EmulatedBoard::Emulator::Options options;
  options.image = emulated_image(setup.choice.link_protocol);
  if (setup.choice.link == "uart") {
    options.coupling = boards::m7::Coupling::kRealTime;
    return std::make_unique<UartBoard>(clock, options);
  }
  return std::make_unique<EmulatedBoard>(cable, end, options);
}

}  // namespace

Flight::Flight(const FlightSetup& setup, std::unique_ptr<Guide> guide)
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
      board_{board_end_, setup.choice.link_protocol},
      other_board_{make_other_board(setup, cable_, board_end_, wire_time_)},
      flown_board_{other_board_ ? other_board_.get() : &board_},
      session_{codec_, flown_board_->link() != nullptr ? *flown_board_->link() : companion_end_,
               companion::Session::Options{}},
      guide_{guide ? std::move(guide) : make_guide(setup)},
      navigator_{make_navigator(setup, session_)},
      director_{director_config(setup), session_, pilot_, *guide_, *navigator_},
      fast_{kStep},
      loop_{time_, rc_, sensors_, board_slot_, dynamics_} {
  time_.source = &fast_;
  board_slot_.board = flown_board_;
  loop_.set_listener(this);
  const auto& faults = setup.faults.faults();
  motor_faults_ = std::any_of(faults.begin(), faults.end(), [](const sim::Fault& fault) {
    return fault.kind == sim::FaultKind::kMotor;
  });
  for (const std::string& name : setup.choice.visualisers) {
    visualisers_.push_back(setup.registry.visualisers.at(name)(setup.vehicle, random_));
    loop_.add(*visualisers_.back());
  }
  if (const auto* wing = std::get_if<WingPlan>(&setup.plan)) {
    face_the_wind();
    wing_guide_ = dynamic_cast<const FixedWingGuide*>(guide_.get());
    wing_record_.emplace(wing->mission.landing.aim_N,
                         wing->autonomy.mission.plan_for(wing->mission).radius_m);
  }
  instruments_ = dynamic_cast<const sim::sensors::StandardSensors*>(healthy_sensors_.get());
  flown_board_->start(loop_.now());
}

/// A fixed wing takes off against the wind, if there is any to speak of, and somebody holds it
/// until then, with a cover on
/// its pitot tube while it is being set up.
void Flight::face_the_wind() {
  constexpr double kCalm_m_s = 2.0;
  dynamics_.set_held(true);
  const sim::Vector3& wind_N = setup_.vehicle.environment().wind.steady_N_m_s;
  if (wind_N.head<2>().norm() < kCalm_m_s) return;
  const double heading = std::atan2(-wind_N.y(), -wind_N.x());
  sim::BodyState state = dynamics_.rest_state();
  state.q_NB = sim::Quaternion(std::cos(0.5 * heading), 0.0, 0.0, std::sin(0.5 * heading));
  if (!dynamics_.set_state(state)) throw std::logic_error("the start against the wind");
}

void Flight::set_tap(LinkTap* tap) {
  board_end_.set_tap(tap);
  companion_end_.set_tap(tap);
  flown_board_->set_link_tap(tap);
}

double Flight::firmware_hover_output() const {
  return setup_.hover_throttle * firmware_value(setup_.firmware, "RC_MAX_THR");
}

void Flight::before_step(sim::Time t) {
  wire_time_ = t;
  apply_faults(t);
  director_.step(t, dynamics_.truth());
  const GuideOutput& output = guide_->output();
  if (output.tracking && director_.stage() == Stage::kFly) {
    tracking_.add((dynamics_.truth().body.p_N - output.setpoint.p_N).norm());
    own_tracking_.add((seen_position_N() - output.setpoint.p_N).head<2>().norm());
  }
  if (wing_record_) sensors_.set_pitot_covered(director_.stage() < Stage::kArm);
  if (wing_record_ && director_.stage() == Stage::kFly) {
    dynamics_.set_held(guide_->output().idle && !guide_->output().landed);
    if (wing_guide_ != nullptr) {
      wing_record_->step(dynamics_.truth(), seen_position_N(), wing_guide_->details());
    }
  }
  if (script_) script_(*this, t);
}

sim::Vector3 Flight::seen_position_N() const {
  const sim::Vector3& p_N = dynamics_.truth().body.p_N;
  const auto& origin = navigator_->origin();
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
  using Breakdown = FlightBoard::Breakdown;
  for (const auto& [kind, breakdown] : {std::pair{sim::FaultKind::kCrash, Breakdown::kCrash},
                                        std::pair{sim::FaultKind::kHang, Breakdown::kHang}}) {
    bool& done = broken_down_[static_cast<std::size_t>(breakdown)];
    const bool active = setup_.faults.active(kind, t);
    if (active && !done) flown_board_->break_down(t, breakdown);
    done = active;
  }
  if (!motor_faults_) return;
  for (std::size_t k = 0; k < setup_.rotors.rotors.size(); ++k) {
    forces_->set_thrust_factor(k, setup_.faults.thrust_factor(k, t));
  }
}

}  // namespace rosflight::apps
