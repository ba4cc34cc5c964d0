// SPDX-License-Identifier: BSD-3-Clause
// In place of the build's policy, in images and programs of tests.
#include "firmware/core/policy/fixed_policy.hpp"

namespace rosflight::core {
namespace {

constexpr Policy kPolicy{"fixed", 0.01f, fixed_policy::step};

}  // namespace

const Policy* built_in_policy() {
  return &kPolicy;
}

}  // namespace rosflight::core
