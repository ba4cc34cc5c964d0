// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "rosflight_common/param_manager.hpp"

namespace roscopter {

using rosflight_common::ParamManager;

}  // namespace roscopter
