// SPDX-License-Identifier: BSD-3-Clause
#include "bench/passthrough/passthrough_flight.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

#include "autonomy/multirotor/controller.hpp"
#include "base/constants.hpp"
#include "companion/listener.hpp"
#include "companion/offboard.hpp"
#include "flight/flight.hpp"

namespace rosflight::bench::passthrough {
namespace {

namespace multirotor = autonomy::multirotor;

double roll_of(const autonomy::Quaternion& q_WB) {
  return autonomy::RollPitch::of(q_WB).roll_rad;
}

flight::FlightChoice choice_of(const PassthroughPlan& plan) {
  flight::FlightChoice choice;
  choice.board = plan.board;
  choice.link = plan.link;
  choice.overrides = {"firmware.PRIMARY_MIXER=geometry", "autonomy.attitude_loops=autonomy"};
  return choice;
}

/// Gains of (1) for the inertia of the vehicle.
multirotor::ControllerConfig loops_for(const flight::FlightSetup& setup) {
  constexpr double kFrequency_rad_s = 12.0, kDamping = 0.8, kIntegral_s = 2.0;
  constexpr double kSlowYaw = 0.3;  // its torque is that of the propellers' drag, which is small
  multirotor::ControllerConfig config =
      std::get<flight::MultirotorPlan>(setup.plan).autonomy.flight.controller;
  const sim::Matrix3& inertia = setup.vehicle.body().inertia_kg_m2;
  const auto gains = [&inertia](int axis, double w) {
    const double kp = inertia(axis, axis) * w * w;
    return autonomy::PidGains{kp, kp / kIntegral_s, 2.0 * kDamping * w * inertia(axis, axis)};
  };
  config.roll_to_torque = gains(0, kFrequency_rad_s);
  config.pitch_to_torque = gains(1, kFrequency_rad_s);
  config.yaw_to_torque = gains(2, kSlowYaw * kFrequency_rad_s);
  return config;
}

/// Climbs, follows the wave and sinks to the ground. step() decides what is flown, 100 times a second; close_loops() sends
/// commands in each step of the world.
class Companion final : public flight::Guidance, private companion::Listener {
 public:
  Companion(const PassthroughPlan& plan, const flight::FlightSetup& setup)
      : plan_{plan},
        config_{loops_for(setup)},
        controller_{config_, std::get<flight::MultirotorPlan>(setup.plan).autonomy.flight.thrust} {}

  void connect(companion::Session& session) {
    session_ = &session;
    session.add(*this);
  }

  const flight::GuidanceOutput& step(const Input& in, const Notify& /*notify*/) override {
    if (armed_at_s_ < 0.0) armed_at_s_ = in.t_s;
    const double flown_s = in.t_s - armed_at_s_ - kIdle_s;
    const double sinking_s = std::max(0.0, flown_s - kClimb_s - plan_.duration_s);
    const double height_m = -in.state.p_W.z() - ground_m_;
    if (flown_s < 0.0) ground_m_ = -in.state.p_W.z();
    const double set_m = std::min(plan_.height_m, flown_s) - kSink_m_s * sinking_s;
    const double lift_m_s2 =
        config_.gravity_m_s2 + 2.0 * (set_m - height_m) + 2.5 * in.state.v_W.z();
    constexpr double kMinLift_m_s2 = 2.0, kMaxLift_m_s2 = 15.0;
    lift_N_ = config_.mass_kg * std::clamp(lift_m_s2, kMinLift_m_s2, kMaxLift_m_s2);
    wave_at_s_ = armed_at_s_ + kIdle_s + kClimb_s;
    flies_ = flown_s >= 0.0 && !landed_;
    landed_ = landed_ || (sinking_s > 0.0 && set_m < -kBelowGround_m);
    if (plan_.shares_attitude) share(in.state);
    out_.idle = !flies_;
    out_.landed = landed_;
    out_.request_disarm = landed_;
    return out_;
  }
  void request_land() override {}

  /// Answers the newest attitude, if one has arrived since the last call.
  void close_loops() {
    if (armed_at_s_ < 0.0 || arrived_s_ == answered_s_) return;
    const double dt_s = std::clamp(arrived_s_ - std::exchange(answered_s_, arrived_s_), 0.0, 0.02);
    const multirotor::AttitudeView view(state_.q_WB);
    if (!flies_) {
      psi_rad_ = view.psi_rad;
      return send({});
    }
    const double t_s = companion::to_seconds(session_->now());
    double roll_rad = 0.0;
    if (waves(t_s)) {
      // The rate setpoint of (1), as a part of the angle: kp (kd/kp) rate.
      const double lead_s = config_.roll_to_torque.kd / config_.roll_to_torque.kp;
      const Triangle wave = Triangle::at(wave_s(t_s), plan_.period_s);
      roll_rad = plan_.amplitude_rad * (wave.value + lead_s * wave.slope_1_s);
    }
    const double thrust_N = lift_N_ / std::max(0.5, view.cos_tilt);
    const multirotor::ControllerCommand command{
        multirotor::ControlMode::kRollPitchYawThrust, {roll_rad, 0.0, psi_rad_, thrust_N}, true};
    send(controller_.step({.state = state_, .attitude = view, .command = command, .dt_s = dt_s})
             .command.u);
  }

  /// Whether roll follows the wave at a time.
  bool waves(double t_s) const {
    return flies_ && t_s >= wave_at_s_ && t_s < wave_at_s_ + plan_.duration_s;
  }
  double wave_s(double t_s) const { return t_s - wave_at_s_; }
  double roll_setpoint(double t_s) const {
    return plan_.amplitude_rad * Triangle::at(wave_s(t_s), plan_.period_s).value;
  }
  double estimated_roll() const { return roll_of(state_.q_WB); }
  std::uint64_t commands() const { return commands_; }

 private:
  static constexpr double kIdle_s = 1.5, kClimb_s = 7.0, kSink_m_s = 0.6, kBelowGround_m = 0.5;

  void on_attitude(const link::Attitude& m, const companion::Stamp& stamp) override {
    const auto number = [](float v) { return static_cast<double>(v); };
    state_.q_WB = autonomy::Quaternion(number(m.q_WB[0]), number(m.q_WB[1]), number(m.q_WB[2]),
                                       number(m.q_WB[3]))
                      .normalized();
    state_.w_B = {number(m.rates_rad_s[0]), number(m.rates_rad_s[1]), number(m.rates_rad_s[2])};
    arrived_s_ = companion::to_seconds(stamp.sample);
  }

  /// As MissionRunner does, which sends none while its commands are paused.
  void share(const autonomy::StateEstimate& estimate) {
    constexpr double kSure_rad = 0.05;
    if (estimate.attitude != autonomy::Quality::kGood ||
        estimate.attitude_sigma_B_rad.head<2>().maxCoeff() >= kSure_rad)
      return;
    const Eigen::Quaternionf q = estimate.q_WB.cast<float>();
    static_cast<void>(
        session_->offboard().send(link::ExternalAttitude{{q.w(), q.x(), q.y(), q.z()}}));
  }

  void send(const std::array<float, link::kCommandAxes>& u) {
    if (session_->offboard().send(companion::pass_through(u)) == companion::SendStatus::kSent)
      ++commands_;
  }

  PassthroughPlan plan_;
  multirotor::ControllerConfig config_;
  multirotor::Controller controller_;
  companion::Session* session_{nullptr};
  multirotor::State state_;  ///< Attitude and rates as they arrived last.
  double armed_at_s_{-1.0}, wave_at_s_{0.0};
  double arrived_s_{0.0}, answered_s_{0.0};  ///< Times of the samples of two attitudes.
  double ground_m_{0.0}, lift_N_{0.0}, psi_rad_{0.0};
  std::uint64_t commands_{0};
  bool flies_{false}, landed_{false};
};

}  // namespace

PassthroughResult fly_passthrough(const PassthroughPlan& plan) {
  const auto setup = std::make_unique<flight::FlightSetup>(choice_of(plan));
  flight::FlightParts parts;
  auto made = std::make_unique<Companion>(plan, *setup);
  Companion& pilot = *made;
  parts.guidance = std::move(made);
  const auto flown = std::make_unique<flight::Flight>(*setup, std::move(parts));
  pilot.connect(flown->session());
  flown->runner().set_offboard_paused(true);
  flown->set_script([&pilot](flight::Flight&, sim::Time) { pilot.close_loops(); });
  PassthroughResult result;
  result.height_min_m = plan.height_m;
  std::uint64_t sent = 0, received = 0;
  while (!flown->finished()) {
    const double t_s = sim::to_seconds(flown->now());
    const std::uint64_t attitudes = flown->session().streams().attitude.count;
    if (pilot.waves(t_s)) {
      const sim::BodyState& body = flown->truth().body;
      const double waved_s = pilot.wave_s(t_s);
      if (result.rows.empty()) {
        sent = pilot.commands();
        received = attitudes;
      } else {
        result.commands_hz = static_cast<double>(pilot.commands() - sent) / waved_s;
        result.attitudes_hz = static_cast<double>(attitudes - received) / waved_s;
      }
      result.rows.push_back({waved_s, pilot.roll_setpoint(t_s) * base::kDegPerRad,
                             roll_of(body.q_WB) * base::kDegPerRad,
                             pilot.estimated_roll() * base::kDegPerRad});
      result.height_min_m = std::min(result.height_min_m, -body.p_W.z());
      result.height_max_m = std::max(result.height_max_m, -body.p_W.z());
    }
    flown->step();
  }
  result.dropped = flown->session().offboard().counters().dropped;
  if (!flown->runner().failure().empty()) throw std::runtime_error(flown->runner().failure());
  if (result.rows.size() < 2) throw std::runtime_error("the wave was not flown");
  return result;
}

}  // namespace rosflight::bench::passthrough
