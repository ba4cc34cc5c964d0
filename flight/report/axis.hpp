// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace rosflight::report {

/// Smallest and largest of the finite values fed; empty until the first.
class Bounds {
 public:
  void include(double value);
  bool empty() const { return low_ > high_; }
  double low() const { return low_; }
  double high() const { return high_; }
  double span() const { return empty() ? 0.0 : high_ - low_; }
  double middle() const { return 0.5 * (low_ + high_); }

 private:
  double low_{1.0};
  double high_{-1.0};
};

/// A straight scale from values to pixels with round ticks.
struct Axis {
  double low{0.0};  ///< Value at pixel_low.
  double high{1.0};
  double pixel_low{0.0};
  double pixel_high{1.0};
  double step{1.0};  ///< Between ticks: 1, 2 or 5 times a power of ten.

  double pixel(double value) const {
    return pixel_low + (value - low) / (high - low) * (pixel_high - pixel_low);
  }
  std::vector<double> ticks() const;
  std::string label(double tick) const;
};

/// Largest of 1, 2, 5 x 10^k that gives at least `wanted` steps in `span`.
double round_step(double span, int wanted);

/// An axis that shows `bounds` with a little room, at least `smallest_span` wide: a quiet signal
/// must not be blown up to look wild. Ends are round. Empty bounds give 0..smallest_span.
Axis value_axis(const Bounds& bounds, double smallest_span, double pixel_low, double pixel_high);

/// Seconds from 0 to end_s: ends where the flight ends; steps of seconds and minutes that people
/// count in.
Axis time_axis(double end_s, double pixel_low, double pixel_high);

/// "12", "0.5"; from three minutes of flight on "2:30".
std::string time_label(double t_s, const Axis& axis);

/// What stands behind the last label: " s" or " min".
std::string_view time_unit(const Axis& axis);

}  // namespace rosflight::report
