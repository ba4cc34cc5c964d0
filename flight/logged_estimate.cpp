// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logged_estimate.hpp"

#include <limits>
#include <tuple>

namespace rosflight::flight {
namespace {

using autonomy::StateEstimate;
using autonomy::estimation::Aid;
using autonomy::estimation::EstimatorHealth;

/// Those of the message; poses of motion capture have a topic of their own.
constexpr std::size_t kLoggedAids = std::tuple_size_v<decltype(LoggedEstimate::innovation)>;
static_assert(static_cast<std::size_t>(Aid::kRest) + 1 == kLoggedAids);

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

std::array<float, 3> three(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::array<float, 2> two(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y())};
}

}  // namespace

LoggedEstimate logged(const StateEstimate& estimate, const EstimatorHealth& health) {
  LoggedEstimate out;
  out.position = three(estimate.p_W);
  out.velocity = three(estimate.v_W);
  out.attitude = {static_cast<float>(estimate.q_WB.w()), static_cast<float>(estimate.q_WB.x()),
                  static_cast<float>(estimate.q_WB.y()), static_cast<float>(estimate.q_WB.z())};
  out.gyro_bias = three(estimate.gyro_bias_B);
  out.accel_bias = three(estimate.accel_bias_B);
  out.wind = out.wind_sigma = {kNone, kNone};
  if (estimate.wind_valid) {
    out.wind = two(estimate.wind_W);
    out.wind_sigma = two(estimate.wind_sigma_W_m_s);
  }
  out.airspeed = estimate.air_valid ? static_cast<float>(estimate.airspeed_m_s) : kNone;
  out.course = static_cast<float>(estimate.course_rad);
  out.position_sigma = three(estimate.p_sigma_W_m);
  out.velocity_sigma = three(estimate.v_sigma_W_m_s);
  out.attitude_sigma = three(estimate.attitude_sigma_B_rad);
  for (std::size_t k = 0; k < kLoggedAids; ++k) {
    out.innovation[k] = static_cast<float>(health.aids[k].nis);
    out.refusing[k] = health.aids[k].rejecting;
  }
  return out;
}

}  // namespace rosflight::flight
