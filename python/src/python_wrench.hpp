// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <nanobind/nanobind.h>

#include <array>
#include <functional>
#include <optional>

#include "sim/modules.hpp"

namespace rosflight::python {

/// A function of Python that changes forces and moments. It sees numbers that change in place, four times a step.
///
/// What it raises, and a wrench that is not finite, is kept until rethrow(); up to there the vehicle's own wrench acts.
class PythonWrench final : public sim::ExternalWrench {
 public:
  /// Position W, velocity W, attitude w x y z, rates, velocity through the air B, outputs; then time at the start of the step,
  /// density, height above the ground.
  static constexpr std::size_t kMotion = 16, kOutputs = std::tuple_size_v<hal::OutputValues>;
  static constexpr std::size_t kInputs = kMotion + kOutputs + 3;

  /// @param time_s  asked at each call.
  explicit PythonWrench(std::function<double()> time_s) : time_s_{std::move(time_s)} {}

  /// @param function  without arguments, or None. Its owner keeps it: a reference from here, through the arrays that it
  ///                  reads, would be a cycle that Python's collector cannot see.
  void set_function(const nanobind::object& function);
  std::array<double, kInputs>& inputs() { return inputs_; }
  /// Force and torque in the body.
  std::array<double, 6>& wrench() { return wrench_; }

  void change(const sim::ForcesAndMoments::Input& in, sim::Wrench& wrench) override;
  bool failed() const { return error_.has_value() || not_finite_; }
  /// Raises what was kept, once; with the interpreter's lock. @throws config::Error  the wrench was not finite.
  void rethrow();

 private:
  std::function<double()> time_s_;
  nanobind::object function_;  ///< Weak.
  std::array<double, kInputs> inputs_{};
  std::array<double, 6> wrench_{};
  std::optional<nanobind::python_error> error_;
  bool not_finite_{false};
};

}  // namespace rosflight::python
