// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flight/report/html.hpp"

namespace rosflight::report {
namespace {

constexpr double kMinutesFrom_s = 180.0;
constexpr double kLargest = 1e12;  // Wilder values would only break the arithmetic of the axis.

int decimals_for(double step) {
  constexpr int kMost = 9;
  return std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, kMost);
}

}  // namespace

void Bounds::include(double value) {
  if (!std::isfinite(value)) return;
  value = std::clamp(value, -kLargest, kLargest);
  low_ = empty() ? value : std::min(low_, value);
  high_ = std::max(high_, value);
}

double round_step(double span, int wanted) {
  const double raw = span / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / power;
  if (ratio >= 5.0) return 5.0 * power;
  return (ratio >= 2.0 ? 2.0 : 1.0) * power;
}

std::vector<double> Axis::ticks() const {
  std::vector<double> out;
  const double slack = 1e-6 * step;
  const auto first = static_cast<long>(std::ceil((low - slack) / step));
  const auto last = static_cast<long>(std::floor((high + slack) / step));
  for (long k = first; k <= last; ++k) out.push_back(static_cast<double>(k) * step);
  return out;
}

std::string Axis::label(double tick) const {
  return number(tick, decimals_for(step));
}

Axis value_axis(const Bounds& bounds, double smallest_span, double pixel_low, double pixel_high) {
  constexpr int kSteps = 3;
  constexpr double kRoom = 0.04;  // Of the span, above and below.
  double low = bounds.empty() ? 0.0 : bounds.low();
  double high = bounds.empty() ? smallest_span : bounds.high();
  // At 1e-6 of the values themselves neighbouring pixels would be the same number.
  const double wanted = std::max({smallest_span, (high - low) * (1.0 + 2.0 * kRoom),
                                  1e-6 * std::max(std::abs(low), std::abs(high))});
  const double middle = 0.5 * (low + high);
  // A quantity that cannot be negative keeps its zero.
  const bool from_zero = low >= 0.0 && low <= wanted * 0.5;
  low = from_zero ? 0.0 : middle - 0.5 * wanted;
  high = from_zero ? std::max(high * (1.0 + kRoom), smallest_span) : middle + 0.5 * wanted;
  const double step = round_step(high - low, kSteps);
  const double half = 0.5 * step;
  return {std::floor(low / half) * half, std::ceil(high / half) * half, pixel_low, pixel_high,
          step};
}

Axis time_axis(double end_s, double pixel_low, double pixel_high) {
  constexpr int kSteps = 6;
  constexpr std::array kSteps_s{15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0};
  constexpr double kShortest_s = 1.0;
  const double end = std::isfinite(end_s) ? std::clamp(end_s, kShortest_s, kLargest) : 1.0;
  double step = round_step(end, kSteps);
  if (end >= kMinutesFrom_s) {
    for (const double candidate : kSteps_s) {
      if (candidate <= end / kSteps) step = candidate;
    }
  }
  return {0.0, end, pixel_low, pixel_high, step};
}

std::string_view time_unit(const Axis& axis) {
  return axis.high < kMinutesFrom_s ? " s" : " min";
}

std::string time_label(double t_s, const Axis& axis) {
  if (axis.high < kMinutesFrom_s) return axis.label(t_s);
  const auto whole = static_cast<long>(std::llround(t_s));
  const std::string seconds = std::to_string(whole % 60);
  return std::to_string(whole / 60) + (seconds.size() < 2 ? ":0" : ":") + seconds;
}

}  // namespace rosflight::report
