// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "python/src/task.hpp"

namespace rosflight::python {

/// Numbers of an action: roll, pitch and yaw rate. The task sets the throttle.
inline constexpr std::size_t kAttitudeActions = 3;

/// Hold commanded angles of roll and pitch and a yaw rate, as the firmware's learned controller has to. Others are
/// commanded at drawn times, with another throttle. Errors are of the truth; the observation is the firmware's.
std::unique_ptr<Task> make_attitude_task(const TaskConfig& config,
                                         const flight::FlightSetup& setup);

}  // namespace rosflight::python
