// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rclcpp {

/// Whether one publisher or subscription passes messages on within the process.
enum class IntraProcessSetting { Enable, Disable, NodeDefault };

}  // namespace rclcpp
