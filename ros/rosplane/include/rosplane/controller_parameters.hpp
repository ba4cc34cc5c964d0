// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "rosplane/wing_parameters.hpp"

namespace rosplane {

/// Parameters of the controller under the names of ROSflight 2.x.
WingTable controller_parameters();

}  // namespace rosplane
