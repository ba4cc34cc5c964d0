// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

namespace rosflight::bench::passthrough {

/// Triangle wave of unit amplitude that starts at 0 and rises.
struct Triangle {
  double value{};
  double slope_1_s{};

  static Triangle at(double t_s, double period_s) {
    const double phase = std::fmod(t_s / period_s + 0.25, 1.0);
    const bool rising = phase < 0.5;
    return {rising ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase, (rising ? 4.0 : -4.0) / period_s};
  }
};

/// One step of the world while the wave is followed. Roll in degrees.
struct Row {
  double t_s{};  ///< Since the wave began.
  double set_deg{};
  double true_deg{};       ///< That of the simulated vehicle.
  double estimated_deg{};  ///< By the firmware, as received.
};

/// How the true roll follows the setpoint.
struct Following {
  double rms_deg{};
  double estimated_rms_deg{};  ///< The same for the firmware's estimate instead of the true roll.
  double max_deg{};
  double lag_s{};                ///< The delay of the setpoint with the smallest rms.
  double rms_without_lag_deg{};  ///< With that delay.
};

/// Rms of true roll less the setpoint `lag` rows before.
inline double rms_with_lag(const std::vector<Row>& rows, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t k = lag; k < rows.size(); ++k)
    sum += std::pow(rows[k].true_deg - rows[k - lag].set_deg, 2);
  return std::sqrt(sum / static_cast<double>(rows.size() - lag));
}

/// @param rows  of equal intervals, at least two. A lag is looked for up to `max_lag_s`.
inline Following judge(const std::vector<Row>& rows, double max_lag_s = 0.5) {
  const double step_s = rows[1].t_s - rows[0].t_s;
  Following out;
  out.rms_deg = out.rms_without_lag_deg = rms_with_lag(rows, 0);
  double sum = 0.0;
  for (const Row& row : rows) {
    out.max_deg = std::fmax(out.max_deg, std::abs(row.true_deg - row.set_deg));
    sum += std::pow(row.estimated_deg - row.set_deg, 2);
  }
  out.estimated_rms_deg = std::sqrt(sum / static_cast<double>(rows.size()));
  for (std::size_t lag = 1; static_cast<double>(lag) * step_s <= max_lag_s && lag + 1 < rows.size();
       ++lag) {
    const double rms = rms_with_lag(rows, lag);
    if (rms >= out.rms_without_lag_deg) continue;
    out.rms_without_lag_deg = rms;
    out.lag_s = static_cast<double>(lag) * step_s;
  }
  return out;
}

}  // namespace rosflight::bench::passthrough
