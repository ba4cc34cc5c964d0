// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>

namespace rosflight::python {

/// Three numbers of a vector. @returns the place behind them.
template <class Vector>
double* put(double* to, const Vector& v) {
  to[0] = v.x(), to[1] = v.y(), to[2] = v.z();
  return to + 3;
}
/// w, x, y, z.
inline double* put(double* to, const Eigen::Quaterniond& q) {
  to[0] = q.w(), to[1] = q.x(), to[2] = q.y(), to[3] = q.z();
  return to + 4;
}

}  // namespace rosflight::python
