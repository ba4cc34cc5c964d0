// SPDX-License-Identifier: BSD-3-Clause
#include "flight/estimate_record.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "autonomy/estimation/rotation.hpp"

namespace rosflight::flight {
namespace {

using autonomy::Quality;
using autonomy::StateEstimate;
using autonomy::estimation::EstimatorHealth;
using autonomy::estimation::kAids;
using report::Tone;

static_assert(kAids == report::Estimate::kAids &&
              kAids == std::tuple_size_v<decltype(LoggedEstimate::innovation)>);

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

std::array<float, 3> three(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::array<float, 2> two(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y())};
}

void show(report::FlightRecord& record, const char* lane, double t_s, Quality trust,
          const char* carried) {
  switch (trust) {
    case Quality::kGood:
      return record.set_state(lane, t_s, "aided", Tone::kGood);
    case Quality::kDeadReckoned:
      return record.set_state(lane, t_s, carried, Tone::kWarning);
    case Quality::kNone:
      return record.set_state(lane, t_s, "lost", Tone::kBad);
  }
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
  for (std::size_t k = 0; k < kAids; ++k) {
    out.innovation[k] = static_cast<float>(health.aids[k].nis);
    out.refusing[k] = health.aids[k].rejecting;
  }
  return out;
}

report::Estimate EstimateRecord::sample(const StateEstimate& estimate,
                                        const EstimatorHealth& health, const sim::Truth& truth,
                                        const sim::Vector3& seen_W) {
  report::Estimate out;
  out.p_W_m = three(estimate.p_W);
  // Down is judged by the truth: the height does not hang on the satellites.
  const sim::Vector3 place_W{seen_W.x(), seen_W.y(), truth.body.p_W.z()};
  out.p_error_m = three(estimate.p_W - place_W);
  out.v_error_m_s = three(estimate.v_W - truth.body.q_WB * truth.body.v_B);
  out.turn_error_rad =
      three(autonomy::estimation::log_rotation(truth.body.q_WB.conjugate() * estimate.q_WB));
  out.p_sigma_m = three(estimate.p_sigma_W_m);
  out.v_sigma_m_s = three(estimate.v_sigma_W_m_s);
  out.turn_sigma_rad = three(estimate.attitude_sigma_B_rad);
  if (estimate.wind_valid) {
    out.wind_W_m_s = two(estimate.wind_W);
    out.wind_sigma_m_s = two(estimate.wind_sigma_W_m_s);
  }
  if (estimate.air_valid) out.airspeed_m_s = static_cast<float>(estimate.airspeed_m_s);
  out.course_rad = static_cast<float>(estimate.course_rad);

  constexpr double kMean_s = 2.0;
  const double t_s = estimate.t_s;
  for (std::size_t k = 0; k < kAids; ++k) {
    const autonomy::estimation::AidHealth& aid = health.aids[k];
    Mean& mean = innovations_[k];
    const std::uint64_t count = aid.accepted + aid.rejected;
    if (count != mean.count) {
      const double share = 1.0 - std::exp(-(t_s - mean.t_s) / kMean_s);
      mean.value += share * (aid.nis - mean.value);
      mean.count = count;
      mean.t_s = t_s;
    }
    if (t_s - mean.t_s < kMean_s) out.innovation[k] = static_cast<float>(mean.value);
  }
  return out;
}

void EstimateRecord::follow(report::FlightRecord& record, double t_s, const StateEstimate& estimate,
                            const EstimatorHealth& health) {
  show(record, "position", t_s, estimate.horizontal, "dead reckoning");
  show(record, "heading", t_s, estimate.heading, "by the gyro alone");
  std::string refused;
  for (std::size_t k = 0; k < kAids; ++k) {
    if (!health.aids[k].rejecting) continue;
    if (!refused.empty()) refused += ", ";
    refused += report::Estimate::kAidNames[k];
  }
  if (refused.empty() && !refused_) return;  // no lane for what never happened
  refused_ = true;
  record.set_state("refused", t_s, refused, Tone::kWarning);
}

}  // namespace rosflight::flight
