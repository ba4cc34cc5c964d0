// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include "firmware/core/test/firmware_rig.hpp"

/// A whole firmware that has settled, for tests of its parameters.
namespace rosflight::core {

class FirmwareParameters : public testing::Test {
 protected:
  void start() {
    rig_.store_quadrotor();
    rig_.start();
    rig_.run_for(500);
    rig_.inbox.clear();
  }
  float value(Param id) const { return rig_.firmware().parameters().get_float(id); }
  std::int32_t number(Param id) const { return rig_.firmware().parameters().get_int(id); }

  FirmwareRig rig_;
};

}  // namespace rosflight::core
