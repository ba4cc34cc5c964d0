// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace rosflight::flight {

/// Root mean square and largest magnitude of errors, in the unit of the errors added.
struct ErrorStatistics {
  std::uint64_t count{};
  double sum_sq{};
  double max{};
  void add(double error) {
    ++count;
    sum_sq += error * error;
    max = std::max(max, std::abs(error));
  }
  /// NaN if nothing was added.
  double rms() const { return count == 0 ? kNone : std::sqrt(sum_sq / static_cast<double>(count)); }
  double largest() const { return count == 0 ? kNone : max; }

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace rosflight::flight
