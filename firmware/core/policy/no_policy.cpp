// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/policy.hpp"

namespace rosflight::core {

const Policy* built_in_policy() {
  return nullptr;
}

}  // namespace rosflight::core
