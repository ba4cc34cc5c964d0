// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rosflight::apps {

/// How well something was followed; signs do not matter.
struct Tracking {
  std::uint64_t count{};
  double sum_sq_m2{};
  double max_m{};
  void add(double error_m) {
    ++count;
    sum_sq_m2 += error_m * error_m;
    max_m = std::max(max_m, std::abs(error_m));
  }
  double rms_m() const {
    return count == 0 ? 0.0 : std::sqrt(sum_sq_m2 / static_cast<double>(count));
  }
};

}  // namespace rosflight::apps
