// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/attitude_task.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "flight/vehicle/vehicle_setup.hpp"

namespace rosflight::python {
namespace {

using sim::Vector3;

class Attitude final : public Task {
 public:
  Attitude(const TaskConfig& config, const flight::FlightSetup& setup) : Task{config} {
    constexpr std::array kLimits{"RC_MAX_ROLL", "RC_MAX_PITCH", "RC_MAX_YAWRATE"};
    for (std::size_t k = 0; k < kLimits.size(); ++k) {
      limits_[k] = flight::firmware_value(setup.firmware, kLimits[k]);
    }
  }

  Start begin(sim::RandomStream& random) override {
    random_ = &random;
    time_s_ = 0.0;
    next();
    return draw_start(random, {0.0, 0.0, -config_.altitude_m}, 0.0, 0.0);
  }
  Vector3 target_W(const Vector3& p_W) const override { return p_W; }

  Verdict judge(const sim::Truth& truth, double dt_s) override {
    constexpr double kTilt_rad = 0.1;
    constexpr double kRate_rad_s = 0.2;
    constexpr double kYawShare = 0.5;
    constexpr double kThere_rad = 5.0 * base::kRadPerDeg;
    const double tilt = tilt_error_rad(truth.body) / kTilt_rad;
    const double yaw = (truth.body.w_B.z() - double{command_.value[5]}) / kRate_rad_s;
    Verdict verdict;
    verdict.lost = truth.on_ground || upright(truth.body) < 0.0;
    verdict.reward =
        turning(truth, dt_s) + dt_s * (1.0 / (1.0 + tilt) + kYawShare / (1.0 + std::abs(yaw)));
    verdict.success = tilt * kTilt_rad < kThere_rad && std::abs(yaw) < 1.0;
    time_s_ += dt_s;
    if (time_s_ >= until_s_) next();
    return verdict;
  }
  Action flown(const Action& action) const override {
    return {throttle_, action[0], action[1], action[2]};
  }
  const core::CommandVector* angles() const override { return &command_; }

 private:
  void next() {
    constexpr double kShortest_s = 0.5;
    constexpr double kLongest_s = 2.0;
    constexpr double kThrottle = 0.25;
    constexpr double kYawShare = 0.7;  // the rate loop does not get to its limit
    for (std::size_t k = 0; k < limits_.size(); ++k) {
      const double share = random_->uniform(-1.0, 1.0);
      // A large tilt for long is rare, since by it the firmware's estimate drifts.
      const double drawn = k < 2 ? share * share * share : kYawShare * share;
      command_.value[3 + k] = static_cast<float>(limits_[k] * drawn);
    }
    throttle_ = static_cast<float>(random_->uniform(-kThrottle, kThrottle));
    until_s_ = time_s_ + random_->uniform(kShortest_s, kLongest_s);
    // The last one lasts for a second at least, so that it can be reached.
    if (until_s_ > config_.episode_s - 1.0) until_s_ = config_.episode_s;
  }

  /// Between the directions of gravity in the body: the true one and the commanded one.
  double tilt_error_rad(const sim::BodyState& body) const {
    const double roll = double{command_.value[3]};
    const double pitch = double{command_.value[4]};
    const Vector3 wanted_B{-std::sin(pitch), std::sin(roll) * std::cos(pitch),
                           std::cos(roll) * std::cos(pitch)};
    const Vector3 down_B = body.q_WB.conjugate() * Vector3::UnitZ();
    return std::atan2(wanted_B.cross(down_B).norm(), wanted_B.dot(down_B));
  }

  std::array<double, 3> limits_{};
  core::CommandVector command_;
  sim::RandomStream* random_{nullptr};
  float throttle_{0.0F};
  double time_s_{0.0};
  double until_s_{0.0};
};

}  // namespace

std::unique_ptr<Task> make_attitude_task(const TaskConfig& config,
                                         const flight::FlightSetup& setup) {
  return std::make_unique<Attitude>(config, setup);
}

}  // namespace rosflight::python
