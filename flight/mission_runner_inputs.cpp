// SPDX-License-Identifier: BSD-3-Clause
// What a MissionRunner gives its guidance: the state, and what the firmware sends, as far as it is fresh.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "flight/mission_runner.hpp"
#include "flight/true_state.hpp"

namespace rosflight::flight {

using link::Severity;

void MissionRunner::update_estimate(const sim::Truth& truth) {
  if (config_.on_truth) {
    estimate_ = true_state(truth);
    return;
  }
  estimate_ = estimate_source_.estimate();
  constexpr double kMaxAge_s = 0.5;
  const bool stale = sim::to_seconds(now_) - estimate_.t_s > kMaxAge_s;
  if (estimate_source_.health().initialised && !stale) {
    if (estimate_.accel_bias_B.allFinite()) accel_bias_B_ = estimate_.accel_bias_B;
    return;
  }
  estimate_.p_W.setConstant(std::numeric_limits<double>::quiet_NaN());
}

/// What the firmware reported last of its outputs, unless that is old.
std::span<const float> MissionRunner::outputs() const {
  constexpr double kMaxAge_s = 0.1;
  const auto& output = session_.streams().output;
  const bool fresh =
      output.count > 0 &&
      sim::to_seconds(now_) - companion::to_seconds(output.stamp.arrival) < kMaxAge_s;
  if (!fresh) return {};
  return output.value.values;
}

/// The newest reading of the range sensor [m], if it is fresh and in range. A vehicle may stand at the near
/// end of the range: noise takes every other reading below it then.
std::optional<double> MissionRunner::range() const {
  constexpr double kMaxAge_s = 0.2;
  const auto& range = session_.streams().range;
  const double reading_m = static_cast<double>(range.value.range_m);
  const bool fresh = range.count > 0 &&
                     sim::to_seconds(now_) - companion::to_seconds(range.stamp.arrival) < kMaxAge_s;
  constexpr double kNearEnd = 0.8;  // of the shortest range
  const bool inside = reading_m >= kNearEnd * static_cast<double>(range.value.min_m) &&
                      reading_m < static_cast<double>(range.value.max_m);
  return fresh && inside && config_.use_range ? std::optional(reading_m) : std::nullopt;
}

/// Time since the newest message of any of the streams that one fault does not stop together.
double MissionRunner::silent_s() const {
  const companion::Streams& streams = session_.streams();
  companion::Time newest{};
  for (const companion::Time arrival :
       {streams.imu.stamp.arrival, streams.attitude.stamp.arrival, streams.status.stamp.arrival,
        streams.heartbeat.stamp.arrival, streams.baro.stamp.arrival,
        streams.output.stamp.arrival}) {
    newest = std::max(newest, arrival);
  }
  return sim::to_seconds(now_) - companion::to_seconds(newest);
}

/// What the firmware sends of the vehicle's motion, each part if it is fresh.
autonomy::RawMotion MissionRunner::raw_motion() const {
  const companion::Streams& streams = session_.streams();
  const auto fresh = [this](const auto& stream, double max_age_s) {
    return stream.count > 0 &&
           sim::to_seconds(now_) - companion::to_seconds(stream.stamp.arrival) < max_age_s;
  };
  const auto vector = [](const std::array<float, 3>& v) {
    return autonomy::Vector3(static_cast<double>(v[0]), static_cast<double>(v[1]),
                             static_cast<double>(v[2]));
  };
  constexpr double kMaxAttitudeAge_s = 0.2;
  constexpr double kMaxImuAge_s = 0.1;
  constexpr double kMaxBaroAge_s = 0.3;
  autonomy::RawMotion raw;
  if (fresh(streams.attitude, kMaxAttitudeAge_s)) {
    const auto& q = streams.attitude.value.q_WB;
    raw.q_WB = autonomy::Quaternion(static_cast<double>(q[0]), static_cast<double>(q[1]),
                                    static_cast<double>(q[2]), static_cast<double>(q[3]));
    raw.w_B = vector(streams.attitude.value.rates_rad_s);
  }
  if (fresh(streams.imu, kMaxImuAge_s))
    raw.a_B = vector(streams.imu.value.accel_m_s2) - accel_bias_B_;
  if (fresh(streams.baro, kMaxBaroAge_s))
    raw.baro_up_m = static_cast<double>(streams.baro.value.altitude_m);
  return raw;
}

/// Notes what changes in the estimate. What follows from it is the guidance's to decide.
void MissionRunner::report_estimate() {
  const autonomy::estimation::EstimatorHealth& health = estimate_source_.health();
  if (!health.initialised) return;
  if (estimate_.horizontal != horizontal_) {
    horizontal_ = estimate_.horizontal;
    if (horizontal_ == autonomy::Quality::kGood) {
      note(Severity::kInfo, "estimator", "position aided");
    } else {
      const bool lost = horizontal_ == autonomy::Quality::kNone;
      note(lost ? Severity::kError : Severity::kWarning, "estimator",
           lost ? "position lost" : "position by dead reckoning");
    }
  }
  if (estimate_.position_unreliable != position_unreliable_) {
    position_unreliable_ = estimate_.position_unreliable;
    note(position_unreliable_ ? Severity::kWarning : Severity::kInfo, "estimator",
         position_unreliable_ ? fmt::format("position unreliable: 3 sigma above {:.0f} m",
                                            autonomy::StateEstimate::kUnreliable_m)
                              : "position reliable again");
  }
  const bool heading = estimate_.heading == autonomy::Quality::kGood;
  if (heading != heading_good_) {
    heading_good_ = heading;
    note(heading ? Severity::kInfo : Severity::kWarning, "estimator",
         heading ? "heading aided" : "heading by the gyro alone");
  }
  const std::uint64_t resets =
      health.gnss_resets + health.baro_relearned + health.ground_relearned + health.restarts;
  if (resets == resets_) return;
  resets_ = resets;
  note(Severity::kWarning, "estimator",
       fmt::format("resets: to GNSS {}, barometer's bias {}, ground {}, all {}", health.gnss_resets,
                   health.baro_relearned, health.ground_relearned, health.restarts));
}

/// Sends the estimated attitude to the firmware as external attitude. The firmware's own filter uses
/// gyro and accelerometer alone: drag and turns bias its tilt. Right after a hole in the data, as of a
/// firmware that restarted, it knows the tilt better than the estimate.
void MissionRunner::send_attitude() {
  constexpr double kSure_rad = 0.05;
  const bool good = estimate_source_.health().initialised && estimate_.p_W.allFinite() &&
                    estimate_.attitude == autonomy::Quality::kGood &&
                    estimate_.attitude_sigma_B_rad.head<2>().maxCoeff() < kSure_rad;
  if (!config_.share_attitude || offboard_paused_ || !good) return;
  const autonomy::Quaternion& q = estimate_.q_WB;
  link::ExternalAttitude attitude;
  attitude.q_WB = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                   static_cast<float>(q.z())};
  static_cast<void>(session_.offboard().send(attitude));
}

}  // namespace rosflight::flight
