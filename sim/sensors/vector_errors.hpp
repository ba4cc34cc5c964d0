// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>

#include "sim/noise.hpp"
#include "sim/types.hpp"

namespace rosflight::sim::sensors {

/// The same law for each of three axes, independent draws, a fixed bias of its own for each.
struct VectorErrorParameters {
  ErrorParameters axis;  ///< `fixed_bias` unused.
  Vector3 fixed_bias{Vector3::Zero()};
};

class VectorErrorModel {
 public:
  /// @param name  prefix of the streams; "/x", "/y" and "/z" are appended.
  VectorErrorModel(const VectorErrorParameters& p, Time period, const RandomSource& source,
                   const std::string& name)
      : axes_{axis(p, 0, period, source, name + "/x"), axis(p, 1, period, source, name + "/y"),
              axis(p, 2, period, source, name + "/z")} {}

  /// ErrorModel::apply for each axis.
  Vector3 apply(const Vector3& truth, double extra_sigma = 0.0) {
    return {axes_[0].apply(truth.x(), extra_sigma), axes_[1].apply(truth.y(), extra_sigma),
            axes_[2].apply(truth.z(), extra_sigma)};
  }
  /// ErrorModel::apply_quietly for each axis.
  Vector3 apply_quietly(const Vector3& truth) {
    return {axes_[0].apply_quietly(truth.x()), axes_[1].apply_quietly(truth.y()),
            axes_[2].apply_quietly(truth.z())};
  }
  Vector3 bias() const { return {axes_[0].bias(), axes_[1].bias(), axes_[2].bias()}; }

 private:
  static ErrorModel axis(const VectorErrorParameters& p, int i, Time period,
                         const RandomSource& source, const std::string& name) {
    ErrorParameters one = p.axis;
    one.fixed_bias = p.fixed_bias[i];
    return {one, period, source, name};
  }

  std::array<ErrorModel, 3> axes_;
};

/// The same numbers in single precision.
inline hal::Vec3 to_floats(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace rosflight::sim::sensors
