// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/common/flight_limits.hpp"
#include "autonomy/common/flight_progress.hpp"
#include "autonomy/common/gap_watch.hpp"
#include "autonomy/multirotor/landing.hpp"
#include "autonomy/multirotor/types.hpp"
#include "autonomy/quadplane/controller.hpp"
#include "autonomy/quadplane/mission.hpp"
#include "autonomy/quadplane/path.hpp"
#include "autonomy/quadplane/phases.hpp"

namespace rosflight::autonomy::quadplane {

/// Output of one step.
struct FlightOutput : FlightProgress<Phase> {
  FirmwareCommand command{};
  bool tracking{};  ///< On the path of the mission, holding all axes.
  multirotor::Trajectory setpoint{};
  double distance_m{};    ///< To the next waypoint.
  double lift_force_N{};  ///< By the rotors.
  double airspeed_m_s{};
};

/// A whole flight of a quad-plane: up, forward along the path, down.
///
/// The speed u over ground along the path rises at the acceleration of the transition to that at which the
/// airspeed is the cruise,
///
///     u_c = w.t + sqrt(V_c^2 - (w x t)^2)            t along the path, w the wind            (1)
///     u <= sqrt(2 a left), k left                    the transition back, to rest at the end (2)
///
/// and the nose turns to where the air will come from in kLead_s. In hover that is against the wind, so a
/// transition down the wind passes airspeed zero and turns the nose there, where the air has no hold of it;
/// u waits until it has turned. After a takeover the path is joined where it is next.
///
/// A battery below its last level stops straight ahead and lands there. One below its second level, a crossed fence and a
/// gap of more than GapWatch::kGoesOn_s turn towards the start, which is flown to like the end of the mission.
///
/// While the pilot flies, the axes that he overrides carry the command that would be in force without him, so the
/// override word shows when he gives back. The free axes, the surfaces, are not commanded then.
class FlightManager {
 public:
  struct Input {
    double t_s{};
    const StateEstimate& state;
    Status status{};
    std::optional<double> range_m;
  };

  FlightManager(const FlightConfig& config, const Mission& mission);
  const FlightOutput& step(const Input& in);
  /// The next steps stop and come down where that leads.
  void request_land() { land_ = true; }
  /// The next steps fly to the start and come down there.
  void request_return() { return_ = true; }
  const FlightOutput& output() const { return out_; }

 private:
  /// Where the path leads.
  enum class Aim : std::uint8_t { kMission, kHere, kStart };

  void enter(Phase phase, const Input& in);
  void take_off(const Input& in);
  bool change_aim(const Input& in);
  void plan(const StateEstimate& state);
  Vector3 start_goal(const Vector3& p_W) const;
  bool guided(const Input& in);
  PhaseConditions conditions(const Input& in);
  void report_passing(const Path::Point& at, const Vector3& p_W);
  void follow_path(const Input& in, Controller::Command& command);
  void fly(const Input& in);
  Controller::Command along_path(const Input& in, const Path::Point& at);
  Controller::Command hold(const Input& in, double down_m_s) const;
  double cruise_over_ground(double course_rad) const;
  double heading_for(const Eigen::Vector2d& v_W) const;

  FlightConfig config_;
  Mission mission_;
  Path path_;
  Controller controller_;
  multirotor::Landing landing_;
  FlightLimits limits_;
  OverrideWatch overrides_;
  GapWatch gaps_;
  Phase phase_{Phase::kDisarmed};
  Vector3 home_W_{Vector3::Zero()};
  Vector3 hold_W_{Vector3::Zero()};
  Vector3 goal_W_{Vector3::Zero()};  ///< End of the path.
  Aim aim_{Aim::kMission};
  bool begun_{};
  Eigen::Vector2d wind_W_{Eigen::Vector2d::Zero()};  ///< Averaged.
  double u_m_s_{};
  double u_rate_m_s2_{};
  double t_s_{};
  double dt_s_{};
  double since_s_{};
  double rests_s_{};
  double hover_thrust_N_{};
  double passed_m_{};  ///< From the path, where the waypoint was passed.
  bool land_{};
  bool return_{};
  multirotor::Landing::Output touching_{};
  FlightOutput out_{};
};

}  // namespace rosflight::autonomy::quadplane
