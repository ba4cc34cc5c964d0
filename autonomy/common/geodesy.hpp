// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/types.hpp"
#include "base/geodesy.hpp"

namespace rosflight::autonomy {

using base::Geodetic;

/// base::to_ecef() with the C library's sine and cosine.
Vector3 ecef_of(const Geodetic& place);

/// North, east, down from `origin` in the plane that touches there: exact up to double rounding
/// (nm), also in that the earth falls away below the plane by d^2/(2 R), 8 cm at 1 km.
Vector3 ned_of(const Geodetic& place, const Geodetic& origin);

}  // namespace rosflight::autonomy
