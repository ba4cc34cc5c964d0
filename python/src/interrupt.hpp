// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <nanobind/nanobind.h>

#include <chrono>
#include <optional>

namespace rosflight::python {

/// Lets Python handle its signals while C++ computes without the interpreter's lock, so that Ctrl-C ends a
/// flight. In threads other than Python's main one it does nothing.
class Interrupt {
 public:
  /// Call it once per step, without the lock. @returns true: a handler raised; end in order, then rethrow().
  bool raised() {
    if (error_) return true;
    if (++calls_ % kCalls != 0) return false;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return false;
    next_ = now + kEvery;
    const nanobind::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() == 0) return false;
    error_.emplace();  // takes the error of this thread over
    return true;
  }

  /// Raises what the handler raised, if it did; with the lock.
  void rethrow() const {
    if (error_) throw nanobind::python_error(*error_);
  }

 private:
  static constexpr unsigned kCalls = 16;  ///< Reading the clock in each would cost.
  static constexpr std::chrono::milliseconds kEvery{20};

  std::optional<nanobind::python_error> error_;
  std::chrono::steady_clock::time_point next_{};
  unsigned calls_{0};
};

}  // namespace rosflight::python
