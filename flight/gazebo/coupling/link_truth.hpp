// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "flight/gazebo/coupling/link_state.hpp"

namespace rosflight::flight::gazebo {

/// The truth of a body that a simulator moves, whatever moved it there: with the states at the ends of a time h,
///
///     f_B = R^T ((v_1 - v_0)/h - g),    dw/dt = (w_1 - w_0)/h            (1)
///
/// v in W. Contacts are in it; a body at rest has f = -g.
class LinkTruth {
 public:
  /// @param c_L  centre of mass in link axes.
  LinkTruth(const sim::Vector3& c_L, double gravity_m_s2)
      : c_L_{c_L}, gravity_W_{0.0, 0.0, gravity_m_s2} {}

  /// Where (1) begins: the body was put there.
  void begin(const sim::BodyState& body) {
    truth_.body = body;
    v_W_ = body.q_WB * body.v_B;
    w_B_ = body.w_B;
    truth_.specific_force_B = body.q_WB.conjugate() * -gravity_W_;
    truth_.angular_acceleration_B.setZero();
  }
  /// After h_s > 0.
  void move(const LinkState& link, double h_s) {
    truth_.body = body_of(link, c_L_, truth_.body.q_WB);
    const sim::Quaternion& q_WB = truth_.body.q_WB;
    const sim::Vector3 v_W = q_WB * truth_.body.v_B;
    truth_.specific_force_B = q_WB.conjugate() * ((v_W - v_W_) / h_s - gravity_W_);
    truth_.angular_acceleration_B = (truth_.body.w_B - w_B_) / h_s;
    v_W_ = v_W;
    w_B_ = truth_.body.w_B;
  }

  /// Motion and accelerations; the rest is the owner's.
  sim::Truth& truth() { return truth_; }
  const sim::Truth& truth() const { return truth_; }
  const sim::Vector3& centre_of_mass_L() const { return c_L_; }

 private:
  sim::Vector3 c_L_;
  sim::Vector3 gravity_W_;
  sim::Vector3 v_W_{sim::Vector3::Zero()};
  sim::Vector3 w_B_{sim::Vector3::Zero()};
  sim::Truth truth_;
};

}  // namespace rosflight::flight::gazebo
