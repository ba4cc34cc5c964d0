// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/hal/roles.hpp"

namespace rosflight::boards {

/// A sensor that a board does not have, or has no driver for yet.
template <class Sample>
class Absent final : public hal::Source<Sample> {
 public:
  bool poll(Sample& /*sample*/) override { return false; }
};

class AbsentBattery final : public hal::Battery {
 public:
  bool poll(hal::BatterySample& /*sample*/) override { return false; }
  void set_multipliers(float /*voltage*/, float /*current*/) override {}
};

}  // namespace rosflight::boards
