// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "messages/frames.hpp"
#include "sim/types.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;

/// A transform of the tree that generic tools read: `child` seen from `parent`.
struct FrameEdge {
  const char* parent;
  const char* child;
  sim::Quaternion rotation;
};

/// The edges that never move. Names and rotations of ROSflight 2.x (world, NED, aircraft_body,
/// stl_frame) with the frames of REP-103 and REP-105 around them:
///
///     map (ENU) -> odom -> world (NWU) -> NED -> aircraft_body (FRD) -> base_link (FLU), stl_frame
///
/// NED -> aircraft_body is the truth and not among these. With a prefix, `map` is the parent of every PREFIX/map, in the same place:
/// the vehicles of one simulation share the origin of their local frames.
inline std::vector<FrameEdge> fixed_frames() {
  constexpr double kHalf = rosflight::messages::kHalfSqrt2;
  const sim::Quaternion roll_pi = rosflight::messages::kFluFromFrd;
  const sim::Quaternion yaw_left{kHalf, 0.0, 0.0, kHalf};  // x of ENU to north
  // roll pi, then yaw -pi/2 about the fixed axes
  const sim::Quaternion stl = sim::Quaternion{kHalf, 0.0, 0.0, -kHalf} * roll_pi;
  return {{"map", "odom", sim::Quaternion::Identity()},
          {"odom", "world", yaw_left},
          {"world", "NED", roll_pi},
          {"aircraft_body", "base_link", roll_pi},
          {"aircraft_body", "stl_frame", stl}};
}

/// Frames of a vehicle in a namespace: "/a/b" -> "a/b/"; nothing in the root.
inline std::string frame_prefix(const std::string& name_space) {
  const auto first = name_space.find_first_not_of('/');
  return first == std::string::npos ? "" : name_space.substr(first) + "/";
}

}  // namespace rosflight_sim
