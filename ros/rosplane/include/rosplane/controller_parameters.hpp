// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "rosplane/fixedwing_parameters.hpp"

namespace rosplane {

/// Parameters of the controller under the names of ROSflight 2.x.
FixedWingTable controller_parameters();

}  // namespace rosplane
