// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace rosflight::apps {

struct TrimOptions {
  std::string vehicle{"anaconda"};
  double speed_m_s{};
  std::optional<double> radius_m;  ///< Radius of the turn, positive to the right; empty: straight.
  double climb_deg{0.0};
  double height_m{0.0};  ///< Above the origin of the vehicle file.
  std::vector<std::string> overrides;
};

/// `./rosflight trim`: state and outputs that hold a flight condition, what is left of the
/// accelerations, and the modes of small deviations from it, beside Lanchester's phugoid.
/// @returns the exit code. @throws config::Error, one line: bad option, no such vehicle, not a
/// fixed wing, a condition it cannot hold.
int trim_command(const TrimOptions& options, std::ostream& out);

}  // namespace rosflight::apps
