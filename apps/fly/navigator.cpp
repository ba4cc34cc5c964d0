// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/navigator.hpp"

#include <algorithm>
#include <cmath>

#include "sim/environment/magnetic_model.hpp"

namespace rosflight::apps {

double wmm2025_declination(const autonomy::estimation::GnssSample& fix) {
  const sim::MagneticModel model = sim::wmm2025();
  const double year = sim::decimal_year(static_cast<std::int64_t>(fix.unix_s));
  const sim::Vector3 field_N =
      model.field_N_T({fix.place.latitude_deg, fix.place.longitude_deg, fix.place.altitude_m},
                      std::clamp(year, model.epoch(), model.end()));
  return std::atan2(field_N.y(), field_N.x());
}

}  // namespace rosflight::apps
