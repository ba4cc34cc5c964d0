// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rmw/qos_profiles.h>
#include <rmw/types.h>

#include "rclcpp/duration.hpp"

namespace rclcpp {

enum class HistoryPolicy {
  KeepLast = RMW_QOS_POLICY_HISTORY_KEEP_LAST,
  KeepAll = RMW_QOS_POLICY_HISTORY_KEEP_ALL,
  SystemDefault = RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT,
  Unknown = RMW_QOS_POLICY_HISTORY_UNKNOWN,
};
enum class ReliabilityPolicy {
  BestEffort = RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT,
  Reliable = RMW_QOS_POLICY_RELIABILITY_RELIABLE,
  SystemDefault = RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT,
  Unknown = RMW_QOS_POLICY_RELIABILITY_UNKNOWN,
};
enum class DurabilityPolicy {
  Volatile = RMW_QOS_POLICY_DURABILITY_VOLATILE,
  TransientLocal = RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL,
  SystemDefault = RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT,
  Unknown = RMW_QOS_POLICY_DURABILITY_UNKNOWN,
};
enum class LivelinessPolicy {
  Automatic = RMW_QOS_POLICY_LIVELINESS_AUTOMATIC,
  ManualByTopic = RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC,
  SystemDefault = RMW_QOS_POLICY_LIVELINESS_SYSTEM_DEFAULT,
  Unknown = RMW_QOS_POLICY_LIVELINESS_UNKNOWN,
};

/// History and depth, with which a QoS starts.
struct QoSInitialization {
  rmw_qos_history_policy_t history_policy;
  std::size_t depth;
  QoSInitialization(rmw_qos_history_policy_t history, std::size_t how_many)
      : history_policy(history), depth(how_many) {}
  static QoSInitialization from_rmw(const rmw_qos_profile_t& profile) {
    return {profile.history, profile.depth};
  }
};
struct KeepAll : QoSInitialization {
  KeepAll() : QoSInitialization(RMW_QOS_POLICY_HISTORY_KEEP_ALL, 0) {}
};
struct KeepLast : QoSInitialization {
  explicit KeepLast(std::size_t how_many)
      : QoSInitialization(RMW_QOS_POLICY_HISTORY_KEEP_LAST, how_many) {}
};

/// Quality of service of one end of a topic. Without more: reliable, volatile, keep last.
class QoS {
 public:
  explicit QoS(const QoSInitialization& initialization,
               const rmw_qos_profile_t& profile = rmw_qos_profile_default);
  QoS(std::size_t history_depth);  // NOLINT: implicit in rclcpp too

  rmw_qos_profile_t& get_rmw_qos_profile() { return profile_; }
  const rmw_qos_profile_t& get_rmw_qos_profile() const { return profile_; }

  QoS& history(HistoryPolicy policy);
  QoS& history(rmw_qos_history_policy_t policy);
  QoS& keep_last(std::size_t depth);
  QoS& keep_all();
  QoS& reliability(ReliabilityPolicy policy);
  QoS& reliability(rmw_qos_reliability_policy_t policy);
  QoS& reliable() { return reliability(ReliabilityPolicy::Reliable); }
  QoS& best_effort() { return reliability(ReliabilityPolicy::BestEffort); }
  QoS& durability(DurabilityPolicy policy);
  QoS& durability(rmw_qos_durability_policy_t policy);
  QoS& durability_volatile() { return durability(DurabilityPolicy::Volatile); }
  QoS& transient_local() { return durability(DurabilityPolicy::TransientLocal); }
  QoS& deadline(const Duration& period);
  QoS& lifespan(const Duration& span);
  QoS& liveliness(LivelinessPolicy policy);
  QoS& liveliness(rmw_qos_liveliness_policy_t policy);
  QoS& liveliness_lease_duration(const Duration& span);
  QoS& avoid_ros_namespace_conventions(bool avoid);

  HistoryPolicy history() const { return static_cast<HistoryPolicy>(profile_.history); }
  std::size_t depth() const { return profile_.depth; }
  ReliabilityPolicy reliability() const {
    return static_cast<ReliabilityPolicy>(profile_.reliability);
  }
  DurabilityPolicy durability() const { return static_cast<DurabilityPolicy>(profile_.durability); }
  Duration deadline() const { return Duration::from_rmw_time(profile_.deadline); }
  Duration lifespan() const { return Duration::from_rmw_time(profile_.lifespan); }
  LivelinessPolicy liveliness() const { return static_cast<LivelinessPolicy>(profile_.liveliness); }
  bool avoid_ros_namespace_conventions() const { return profile_.avoid_ros_namespace_conventions; }

 private:
  rmw_qos_profile_t profile_;
};

bool operator==(const QoS& left, const QoS& right);
bool operator!=(const QoS& left, const QoS& right);

/// The ready-made ones; each takes another history if given one.
class SensorDataQoS : public QoS {
 public:
  explicit SensorDataQoS(const QoSInitialization& initialization =
                             QoSInitialization::from_rmw(rmw_qos_profile_sensor_data))
      : QoS(initialization, rmw_qos_profile_sensor_data) {}
};
class ParametersQoS : public QoS {
 public:
  explicit ParametersQoS(const QoSInitialization& initialization =
                             QoSInitialization::from_rmw(rmw_qos_profile_parameters))
      : QoS(initialization, rmw_qos_profile_parameters) {}
};
class ServicesQoS : public QoS {
 public:
  explicit ServicesQoS(const QoSInitialization& initialization =
                           QoSInitialization::from_rmw(rmw_qos_profile_services_default))
      : QoS(initialization, rmw_qos_profile_services_default) {}
};
class ParameterEventsQoS : public QoS {
 public:
  explicit ParameterEventsQoS(const QoSInitialization& initialization =
                                  QoSInitialization::from_rmw(rmw_qos_profile_parameter_events))
      : QoS(initialization, rmw_qos_profile_parameter_events) {}
};
class SystemDefaultsQoS : public QoS {
 public:
  explicit SystemDefaultsQoS(const QoSInitialization& initialization =
                                 QoSInitialization::from_rmw(rmw_qos_profile_system_default))
      : QoS(initialization, rmw_qos_profile_system_default) {}
};
/// Best effort, depth 1: an old time is of no use.
class ClockQoS : public QoS {
 public:
  explicit ClockQoS(const QoSInitialization& initialization = KeepLast(1))
      : QoS(initialization, rmw_qos_profile_sensor_data) {}
};
/// Reliable, transient local, kept for 10 s.
class RosoutQoS : public QoS {
 public:
  explicit RosoutQoS(const QoSInitialization& initialization = KeepLast(1000))
      : QoS(initialization) {
    transient_local().lifespan(Duration(10, 0));
  }
};

}  // namespace rclcpp
