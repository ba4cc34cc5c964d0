// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "ros/rosplane/src/wing_parameters.hpp"

namespace rosflight::ros_plane {

/// Parameters of the controller under the names of ROSflight 2.x.
std::vector<WingParameter> controller_parameters();

}  // namespace rosflight::ros_plane
