// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/common/types.hpp"

namespace rosflight::autonomy {

/// What a flight controller sends by itself, for a flight whose state is lost. A member is empty unless it
/// is fresh.
struct RawMotion {
  std::optional<Quaternion> q_WB;   ///< Attitude by the flight controller's own filter.
  std::optional<Vector3> w_B;       ///< Rates by that filter.
  std::optional<Vector3> a_B;       ///< Specific force, the last known bias removed.
  std::optional<double> baro_up_m;  ///< Altitude by the barometer, from any origin.
};

}  // namespace rosflight::autonomy
