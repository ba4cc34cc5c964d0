// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/learner.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "companion/offboard.hpp"
#include "firmware/core/firmware.hpp"
#include "flight/vehicle/vehicle_setup.hpp"

namespace rosflight::python {
namespace {

constexpr double kStep_s = 1e-6 * static_cast<double>(flight::Simulation::kStep.count());

ActionLevel level_of(const std::string& name) {
  if (name == "motors") return ActionLevel::kMotors;
  if (name == "rates") return ActionLevel::kRates;
  if (name == "angles") return ActionLevel::kAngles;
  throw config::Error(fmt::format("action: found '{}', allowed motors, rates, angles", name));
}

sim::RandomStream episodes(std::uint64_t seed) {
  return sim::RandomSource{seed}.stream("python/episodes");
}

}  // namespace

ActionMap::ActionMap(const flight::FlightSetup& setup, const std::string& level)
    : level_{level_of(level)}, hover_throttle_{static_cast<float>(setup.hover_throttle)} {
  if (setup.fixed_wing()) {
    throw config::Error(
        fmt::format("vehicle: found {}, a fixed wing, allowed a multirotor", setup.choice.vehicle));
  }
  const auto value = [&setup](const char* name) {
    return static_cast<float>(flight::firmware_value(setup.firmware, name));
  };
  if (level_ == ActionLevel::kRates) {
    scale_ = {value("RC_MAX_ROLLRATE"), value("RC_MAX_PITCHRATE"), value("RC_MAX_YAWRATE")};
  } else {
    scale_ = {value("RC_MAX_ROLL"), value("RC_MAX_PITCH"), value("RC_MAX_YAWRATE")};
  }
  const bool direct = setup.rotors.rotors.size() == kActions && value("USE_MOTOR_PARAM") == 0.0F;
  if (level_ == ActionLevel::kMotors && !direct) {
    throw config::Error(
        fmt::format("action: found motors for {}, allowed for four rotors and USE_MOTOR_PARAM 0",
                    setup.choice.vehicle));
  }
}

void ActionMap::read_mixer(const core::Firmware& firmware) {
  constexpr int kInputs = 6;
  const Eigen::Matrix<double, kActions, kInputs> gains =
      firmware.mixer().primary().topLeftCorner<kActions, kInputs>().cast<double>();
  // The least-norm inputs of the mixer that give these outputs.
  const Eigen::Matrix<double, kInputs, kActions> inverse =
      gains.completeOrthogonalDecomposition().pseudoInverse();
  for (int row = 0; row < kInputs; ++row) {
    for (int k = 0; k < static_cast<int>(kActions); ++k) {
      inverse_[static_cast<std::size_t>(row)][static_cast<std::size_t>(k)] =
          static_cast<float>(inverse(row, k));
    }
  }
}

float ActionMap::throttle(float action) const {
  return action < 0.0F ? hover_throttle_ * (1.0F + action)
                       : hover_throttle_ + (1.0F - hover_throttle_) * action;
}

link::OffboardControl ActionMap::command(const Action& given) const {
  Action a = given;
  for (float& value : a) value = std::clamp(value, -1.0F, 1.0F);
  if (level_ == ActionLevel::kRates) {
    return companion::body_rates(scale_[0] * a[1], scale_[1] * a[2], scale_[2] * a[3],
                                 throttle(a[0]));
  }
  if (level_ == ActionLevel::kAngles) {
    return companion::angles(scale_[0] * a[1], scale_[1] * a[2], scale_[2] * a[3], throttle(a[0]));
  }
  std::array<float, link::kCommandAxes> u{};
  for (std::size_t row = 0; row < inverse_.size(); ++row) {
    for (std::size_t k = 0; k < kActions; ++k) u[row] += inverse_[row][k] * 0.5F * (a[k] + 1.0F);
  }
  return companion::pass_through(u);
}

Learner::Learner(flight::FlightSetup& setup, const TaskConfig& task, const std::string& level,
                 std::uint64_t seed)
    : task_{task},
      map_{setup, level},
      seed_{seed},
      simulation_{(setup.choice.seed = seed, setup)},
      random_{episodes(seed)} {}

void Learner::start() {
  simulation_.start();
  map_.read_mixer(simulation_.firmware());
  simulation_.drop_link();
  // Held on the ground, so that the firmware has no error to integrate.
  simulation_.set_held(true);
  constexpr int kCommands = 100;
  const auto throttle = static_cast<float>(simulation_.setup().hover_throttle);
  for (int k = 0; k < kCommands; ++k) {
    simulation_.tell(companion::body_rates(0.0F, 0.0F, 0.0F, throttle));
    simulation_.step();
  }
  simulation_.set_held(false);
  const std::span<const double> turning = simulation_.module_state();
  hovering_.assign(turning.begin(), turning.end());
  armed_ = simulation_.save();
}

void Learner::rewind() {
  simulation_.restore(*armed_);
  random_ = episodes(seed_);
  begin_episode();
}

sim::Vector3 Learner::draw_in_ball(double radius) {
  sim::Vector3 v;
  do {
    for (int k = 0; k < 3; ++k) v[k] = random_.uniform(-1.0, 1.0);
  } while (v.squaredNorm() > 1.0);
  return radius * v;
}

void Learner::next_waypoint() {
  constexpr double kCourse_m = 4.0;
  const sim::Vector3 centre_W{0.0, 0.0, -task_.altitude_m - 1.0};
  target_W_ = next_W_;
  next_W_ = centre_W + draw_in_ball(kCourse_m);
}

void Learner::begin_episode() {
  simulation_.restore_firmware(*armed_);
  target_W_ = next_W_ = {0.0, 0.0, -task_.altitude_m};
  if (task_.task == "waypoints") {
    next_waypoint();
    next_waypoint();
  }
  sim::BodyState state;
  state.p_W = target_W_ + draw_in_ball(task_.start_radius_m);
  const double yaw = random_.uniform(-base::kPi, base::kPi);
  const double along = random_.uniform(-base::kPi, base::kPi);
  const double tilt = random_.uniform(0.0, task_.start_tilt_rad);
  state.q_WB = Eigen::AngleAxisd(tilt, sim::Vector3{std::cos(along), std::sin(along), 0.0}) *
               Eigen::AngleAxisd(yaw, sim::Vector3::UnitZ());
  state.v_B = state.q_WB.conjugate() * draw_in_ball(task_.start_speed_m_s);
  state.w_B = draw_in_ball(task_.start_rates_rad_s);
  place(state);
  action_ = {};
  steps_ = 0;
  reached_ = 0;
}

void Learner::place(const sim::BodyState& state) {
  if (!simulation_.set_state(state, hovering_))
    throw config::Error("reset: found a start below the ground, allowed above it");
}

Learner::Result Learner::step(const Action& action, int substeps) {
  action_ = action;
  const double before_m = to_target().norm();
  simulation_.tell(map_.command(action));
  for (int k = 0; k < substeps; ++k) simulation_.step();
  steps_ += substeps;

  const sim::Truth& truth = simulation_.truth();
  const double distance_m = to_target().norm();
  const double upright = (truth.body.q_WB * sim::Vector3::UnitZ()).z();
  constexpr double kLost_m = 10.0;
  const double far_m = task_.task == "waypoints" ? 2.0 * kLost_m : kLost_m;
  Result result;
  result.terminated = truth.on_ground || distance_m > far_m || upright < 0.0 ||
                      !simulation_.firmware().state().armed();
  result.truncated = !result.terminated && steps_ * kStep_s >= task_.episode_s;
  const double dt_s = substeps * kStep_s;
  constexpr double kTurning = 0.02;  // of the squared rate [s/rad^2]
  constexpr double kCrash = 2.0;
  double reward = -dt_s * kTurning * truth.body.w_B.squaredNorm();
  if (task_.task == "waypoints") {
    reward += before_m - distance_m;
    if (distance_m < task_.waypoint_radius_m) {
      reward += 1.0;
      ++reached_;
      next_waypoint();
    }
  } else {
    reward += dt_s / (1.0 + distance_m * distance_m);
  }
  if (result.terminated) reward -= kCrash;
  if (task_.task == "waypoints" && reached_ >= task_.waypoints) result.terminated = true;
  result.reward = static_cast<float>(reward);
  return result;
}

void Learner::observe(float* out) const {
  const sim::BodyState& body = simulation_.truth().body;
  const auto put = [&out](const auto& v) {
    for (int k = 0; k < 3; ++k) *out++ = static_cast<float>(v[k]);
  };
  put(to_target());
  put(sim::Vector3(body.q_WB * body.v_B));
  const sim::Matrix3 R_WB = body.q_WB.toRotationMatrix();
  for (int row = 0; row < 3; ++row) put(R_WB.row(row));
  put(body.w_B);
  out = std::ranges::copy(action_, out).out;
  if (task_.task == "waypoints") put(sim::Vector3(next_W_ - target_W_));
}

}  // namespace rosflight::python
