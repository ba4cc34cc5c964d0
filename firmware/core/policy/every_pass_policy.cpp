// SPDX-License-Identifier: BSD-3-Clause
// A policy of two layers of 64 that is inferred in each pass with an IMU sample.
#include "firmware/core/policy/fixed_policy.hpp"

namespace rosflight::core {
namespace {

constexpr Policy kPolicy{"every_pass", 0.0f, fixed_policy::step};

}  // namespace

const Policy* built_in_policy() {
  return &kPolicy;
}

}  // namespace rosflight::core
