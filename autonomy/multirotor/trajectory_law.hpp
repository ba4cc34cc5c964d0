// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/multirotor/angles.hpp"
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

/// What flies a trajectory: a point of it and the state in, a command of any mode out. Replaceable:
/// FlightManager takes one; TrajectoryFollower is the one it has by itself
/// (docs/autonomy/replace-a-module.md).
class TrajectoryLaw {
 public:
  struct Input {
    const State& state;
    const AttitudeView& attitude;  ///< Computed from state.q_WB.
    const Trajectory& setpoint;
    double setpoint_age_s{};
    double dt_s{};          ///< <= 0: the last output is repeated.
    PilotOverride pilot{};  ///< Integrals of the axes the pilot holds are cleared.
  };

  TrajectoryLaw() = default;
  TrajectoryLaw(const TrajectoryLaw&) = default;
  TrajectoryLaw& operator=(const TrajectoryLaw&) = default;
  TrajectoryLaw(TrajectoryLaw&&) = default;
  TrajectoryLaw& operator=(TrajectoryLaw&&) = default;
  virtual ~TrajectoryLaw() = default;

  /// Called at each step of a flight in which a trajectory is flown; must not allocate. Not valid:
  /// the vehicle holds its position from the next step on.
  virtual ControllerCommand step(const Input& in) = 0;
  /// As new, but for the acceleration trim_W that another loop has found to hold the vehicle in
  /// place. Called when a trajectory begins.
  virtual void restart(const Vector3& trim_W) = 0;
  /// The present integrals as an acceleration; handed to the loops that take over.
  virtual Vector3 trim_W() const = 0;
};

}  // namespace rosflight::autonomy::multirotor
