// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/python_wrench.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "config/strict_yaml.hpp"
#include "python/src/put.hpp"

namespace rosflight::python {

void PythonWrench::set_function(const nanobind::object& function) {
  function_ = function.is_none() ? nanobind::none() : nanobind::object(nanobind::weakref(function));
}

void PythonWrench::change(const sim::ForcesAndMoments::Input& in, sim::Wrench& wrench) {
  if (failed()) return;
  double* to = put(inputs_.data(), in.body.p_W);
  to = put(to, sim::Vector3(in.R_WB * in.body.v_B));
  to = put(to, in.body.q_WB);
  to = put(to, in.body.w_B);
  to = put(to, in.v_air_B);
  to = std::ranges::copy(in.outputs, to).out;
  *to++ = time_s_();
  *to++ = in.air.density_kg_m3;
  *to = in.height_above_ground_m;
  put(put(wrench_.data(), wrench.force_B), wrench.torque_B);
  const nanobind::gil_scoped_acquire lock;
  try {
    const nanobind::object function = function_();
    if (function.is_none()) return;
    function();
  } catch (nanobind::python_error& error) {
    error_.emplace(std::move(error));
    return;
  }
  not_finite_ = !std::ranges::all_of(wrench_, [](double x) { return std::isfinite(x); });
  if (not_finite_) return;
  wrench.force_B = {wrench_[0], wrench_[1], wrench_[2]};
  wrench.torque_B = {wrench_[3], wrench_[4], wrench_[5]};
}

void PythonWrench::rethrow() {
  if (std::exchange(not_finite_, false)) {
    throw config::Error(
        "forces: found NaN or infinity in what the function left, allowed finite numbers");
  }
  if (error_) throw nanobind::python_error(*std::exchange(error_, std::nullopt));
}

}  // namespace rosflight::python
