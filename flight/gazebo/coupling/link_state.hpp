// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "messages/frames.hpp"
#include "sim/dynamics/physics_engine.hpp"
#include "sim/types.hpp"

/// A link of Gazebo in the axes of Gazebo, and the vehicle in ours.
///
/// G: the world, x east, y north, z up, the same origin as W. L: the link, forward, left, up, with its origin
/// anywhere; c_L is the centre of mass in it. B has its origin at the centre of mass.
namespace rosflight::flight::gazebo {

struct LinkState {
  sim::Vector3 p_G{sim::Vector3::Zero()};  ///< The link's origin.
  sim::Quaternion q_GL{sim::Quaternion::Identity()};
  sim::Vector3 v_G{sim::Vector3::Zero()};  ///< Its velocity.
  sim::Vector3 w_G{sim::Vector3::Zero()};
};

/// What acts at the link's origin.
struct LinkWrench {
  sim::Vector3 force_G{sim::Vector3::Zero()};
  sim::Vector3 torque_G{sim::Vector3::Zero()};
};

inline bool finite(const LinkState& state) {
  return state.p_G.allFinite() && state.q_GL.coeffs().allFinite() && state.v_G.allFinite() &&
         state.w_G.allFinite();
}

/// The motion of the centre of mass. Of the two quaternions of an attitude the one next to `near`.
inline sim::BodyState body_of(const LinkState& link, const sim::Vector3& c_L,
                              const sim::Quaternion& near = sim::Quaternion::Identity()) {
  using messages::enu;
  const sim::Vector3 arm_G = link.q_GL * c_L;
  sim::BodyState body;
  body.q_WB = messages::kEnuFromNed.conjugate() * link.q_GL * messages::kFluFromFrd;
  body.q_WB.normalize();
  if (body.q_WB.dot(near) < 0.0) body.q_WB.coeffs() = -body.q_WB.coeffs();
  body.p_W = enu(link.p_G + arm_G);
  body.v_B = body.q_WB.conjugate() * enu(link.v_G + link.w_G.cross(arm_G));
  body.w_B = body.q_WB.conjugate() * enu(link.w_G);
  return body;
}

/// The other way.
inline LinkState link_of(const sim::BodyState& body, const sim::Vector3& c_L) {
  using messages::enu;
  LinkState link;
  link.q_GL = messages::q_map_base(body.q_WB).normalized();
  link.w_G = enu(body.q_WB * body.w_B);
  const sim::Vector3 arm_G = link.q_GL * c_L;
  link.p_G = enu(body.p_W) - arm_G;
  link.v_G = enu(body.q_WB * body.v_B) - link.w_G.cross(arm_G);
  return link;
}

/// A load at the centre of mass as one at the link's origin. @param q_GL  attitude of the link now.
inline LinkWrench link_wrench(const sim::PhysicsEngine::Load& load, const sim::Quaternion& q_GL,
                              const sim::Vector3& c_L) {
  const sim::Vector3 force_G = messages::enu(load.force_W);
  return {force_G, q_GL * messages::flu(load.torque_B) + (q_GL * c_L).cross(force_G)};
}

}  // namespace rosflight::flight::gazebo
