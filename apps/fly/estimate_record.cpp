// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/estimate_record.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "autonomy/estimation/rotation.hpp"

namespace rosflight::apps {
namespace {

using autonomy::StateEstimate;
using autonomy::Trust;
using autonomy::estimation::EstimatorHealth;
using autonomy::estimation::kAids;
using report::Tone;

static_assert(kAids == report::Estimate::kAids && kAids == log::Estimate::kAids);

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

std::array<float, 3> three(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::array<float, 2> two(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y())};
}

void show(report::FlightRecord& record, const char* lane, double t_s, Trust trust,
          const char* carried) {
  switch (trust) {
    case Trust::kGood:
      return record.set_state(lane, t_s, "aided", Tone::kGood);
    case Trust::kDeadReckoned:
      return record.set_state(lane, t_s, carried, Tone::kWarning);
    case Trust::kNone:
      return record.set_state(lane, t_s, "lost", Tone::kBad);
  }
}

}  // namespace

log::Estimate logged(const StateEstimate& estimate, const EstimatorHealth& health) {
  log::Estimate out;
  out.p_N_m = three(estimate.p_N);
  out.v_N_m_s = three(estimate.v_N);
  out.q_NB = {static_cast<float>(estimate.q_NB.w()), static_cast<float>(estimate.q_NB.x()),
              static_cast<float>(estimate.q_NB.y()), static_cast<float>(estimate.q_NB.z())};
  out.gyro_bias_rad_s = three(estimate.gyro_bias_B);
  out.accel_bias_m_s2 = three(estimate.accel_bias_B);
  out.wind_N_m_s = out.wind_sigma_m_s = {kNone, kNone};
  if (estimate.wind_valid) {
    out.wind_N_m_s = two(estimate.wind_N);
    out.wind_sigma_m_s = two(estimate.wind_sigma_N_m_s);
  }
  out.airspeed_m_s = estimate.air_valid ? static_cast<float>(estimate.airspeed_m_s) : kNone;
  out.course_rad = static_cast<float>(estimate.course_rad);
  out.p_sigma_m = three(estimate.p_sigma_N_m);
  out.v_sigma_m_s = three(estimate.v_sigma_N_m_s);
  out.attitude_sigma_rad = three(estimate.attitude_sigma_B_rad);
  for (std::size_t k = 0; k < kAids; ++k) {
    out.innovation[k] = static_cast<float>(health.aids[k].nis);
    out.refusing[k] = health.aids[k].refusing;
  }
  return out;
}

report::Estimate EstimateRecord::sample(const StateEstimate& estimate,
                                        const EstimatorHealth& health, const sim::Truth& truth,
                                        const sim::Vector3& seen_N) {
  report::Estimate out;
  out.p_N_m = three(estimate.p_N);
  // Down is judged by the truth: the height does not hang on the satellites.
  const sim::Vector3 place_N{seen_N.x(), seen_N.y(), truth.body.p_N.z()};
  out.p_error_m = three(estimate.p_N - place_N);
  out.v_error_m_s = three(estimate.v_N - truth.body.q_NB * truth.body.v_B);
  out.turn_error_rad =
      three(autonomy::estimation::log_rotation(truth.body.q_NB.conjugate() * estimate.q_NB));
  out.p_sigma_m = three(estimate.p_sigma_N_m);
  out.v_sigma_m_s = three(estimate.v_sigma_N_m_s);
  out.turn_sigma_rad = three(estimate.attitude_sigma_B_rad);
  if (estimate.wind_valid) {
    out.wind_N_m_s = two(estimate.wind_N);
    out.wind_sigma_m_s = two(estimate.wind_sigma_N_m_s);
  }
  if (estimate.air_valid) out.airspeed_m_s = static_cast<float>(estimate.airspeed_m_s);
  out.course_rad = static_cast<float>(estimate.course_rad);

  constexpr double kMean_s = 2.0;
  const double t_s = estimate.t_s;
  for (std::size_t k = 0; k < kAids; ++k) {
    const autonomy::estimation::AidHealth& aid = health.aids[k];
    Mean& mean = innovations_[k];
    const std::uint64_t count = aid.accepted + aid.refused;
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
    if (!health.aids[k].refusing) continue;
    if (!refused.empty()) refused += ", ";
    refused += report::Estimate::kAidNames[k];
  }
  if (refused.empty() && !refused_) return;  // no lane for what never happened
  refused_ = true;
  record.set_state("refused", t_s, refused, Tone::kWarning);
}

}  // namespace rosflight::apps
