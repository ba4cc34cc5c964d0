// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/qos.hpp"

#include <rmw/qos_profiles.h>
#include <rmw/time.h>

namespace rclcpp {

QoS::QoS(const QoSInitialization& initialization, const rmw_qos_profile_t& profile)
    : profile_(profile) {
  profile_.history = initialization.history_policy;
  profile_.depth = initialization.depth;
}
QoS::QoS(std::size_t history_depth) : QoS(KeepLast(history_depth)) {}

QoS& QoS::history(HistoryPolicy policy) {
  return history(static_cast<rmw_qos_history_policy_t>(policy));
}
QoS& QoS::history(rmw_qos_history_policy_t policy) {
  profile_.history = policy;
  return *this;
}
QoS& QoS::keep_last(std::size_t depth) {
  profile_.depth = depth;
  return history(HistoryPolicy::KeepLast);
}
QoS& QoS::keep_all() {
  profile_.depth = 0;
  return history(HistoryPolicy::KeepAll);
}
QoS& QoS::reliability(ReliabilityPolicy policy) {
  return reliability(static_cast<rmw_qos_reliability_policy_t>(policy));
}
QoS& QoS::reliability(rmw_qos_reliability_policy_t policy) {
  profile_.reliability = policy;
  return *this;
}
QoS& QoS::durability(DurabilityPolicy policy) {
  return durability(static_cast<rmw_qos_durability_policy_t>(policy));
}
QoS& QoS::durability(rmw_qos_durability_policy_t policy) {
  profile_.durability = policy;
  return *this;
}
QoS& QoS::deadline(const Duration& period) {
  profile_.deadline = period.to_rmw_time();
  return *this;
}
QoS& QoS::lifespan(const Duration& span) {
  profile_.lifespan = span.to_rmw_time();
  return *this;
}
QoS& QoS::liveliness(LivelinessPolicy policy) {
  return liveliness(static_cast<rmw_qos_liveliness_policy_t>(policy));
}
QoS& QoS::liveliness(rmw_qos_liveliness_policy_t policy) {
  profile_.liveliness = policy;
  return *this;
}
QoS& QoS::liveliness_lease_duration(const Duration& span) {
  profile_.liveliness_lease_duration = span.to_rmw_time();
  return *this;
}
QoS& QoS::avoid_ros_namespace_conventions(bool avoid) {
  profile_.avoid_ros_namespace_conventions = avoid;
  return *this;
}

bool operator==(const QoS& left, const QoS& right) {
  const auto& a = left.get_rmw_qos_profile();
  const auto& b = right.get_rmw_qos_profile();
  return a.history == b.history && a.depth == b.depth && a.reliability == b.reliability &&
         a.durability == b.durability && rmw_time_equal(a.deadline, b.deadline) &&
         rmw_time_equal(a.lifespan, b.lifespan) && a.liveliness == b.liveliness &&
         rmw_time_equal(a.liveliness_lease_duration, b.liveliness_lease_duration) &&
         a.avoid_ros_namespace_conventions == b.avoid_ros_namespace_conventions;
}
bool operator!=(const QoS& left, const QoS& right) {
  return !(left == right);
}

}  // namespace rclcpp
