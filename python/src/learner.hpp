// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "flight/simulation.hpp"
#include "link/messages.hpp"

namespace rosflight::python {

inline constexpr std::size_t kActions = 4;
using Action = std::array<float, kActions>;

/// What the four numbers of an action are, each -1 to 1.
enum class ActionLevel : std::uint8_t {
  kMotors,  ///< Outputs of motors 0 to 3, -1: off, 1: full; through pass-through and the inverse of the mixer.
  kRates,  ///< Throttle (0: what hovers), roll, pitch and yaw rate over the firmware's limits of the sticks.
  kAngles,  ///< Throttle, roll, pitch, and yaw rate likewise.
};

/// Actions as the commands that a companion of this vehicle sends.
class ActionMap {
 public:
  /// @throws config::Error  the level is unknown, or this vehicle does not have it.
  ActionMap(const flight::FlightSetup& setup, const std::string& level);
  /// With the mixer that the firmware computed; once it runs.
  void read_mixer(const core::Firmware& firmware);

  link::OffboardControl command(const Action& action) const;

 private:
  float throttle(float action) const;

  ActionLevel level_;
  float hover_throttle_;
  std::array<float, 3> scale_{};  ///< Roll, pitch, yaw at 1.
  std::array<std::array<float, kActions>, 6>
      inverse_{};  ///< Inputs of the mixer by outputs of motors.
};

/// What a learner is to do. Positions are in W.
struct TaskConfig {
  std::string task{"hover"};  ///< Or "waypoints".
  double episode_s{10.0};
  double altitude_m{5.0};  ///< Altitude of the hover, and 1 m below the middle of the waypoints.
  double start_radius_m{
      1.0};  ///< Start: within this distance of the first target, uniform in the ball, ...
  double start_tilt_rad{0.5};  ///< ... tilted by up to this, any heading, ...
  double start_speed_m_s{1.0};
  double start_rates_rad_s{1.0};
  std::size_t waypoints{5};
  double waypoint_radius_m{0.5};
};

/// One vehicle and its episodes.
class Learner {
 public:
  struct Result {
    float reward{};
    bool terminated{};
    bool truncated{};
  };

  /// Numbers of an observation: target less position 3, velocity 3, rotation matrix 9 (rows, body to W), rates 3, last
  /// action 4; with waypoints the next target less this one 3.
  static std::size_t observation_size(const std::string& task) {
    return task == "waypoints" ? 25 : 22;
  }

  /// @param setup, task  must outlive this. @param seed  of its noise and its episodes.
  Learner(flight::FlightSetup& setup, const TaskConfig& task, const std::string& level,
          std::uint64_t seed);

  /// Powers it up, arms it, lets the rotors turn as in hover and leaves out the link. @throws flight::Simulation::Error  it does not arm.
  void start();
  /// As right after start(): the first episode again.
  void rewind();
  /// A new episode; the noise of sensors and air goes on.
  void begin_episode();
  /// @param substeps  steps of 2.5 ms.
  Result step(const Action& action, int substeps);
  void observe(float* out) const;
  const sim::Truth& truth() const { return simulation_.truth(); }
  const hal::OutputValues& outputs() const { return simulation_.outputs(); }
  std::size_t reached() const { return reached_; }
  double distance_m() const { return to_target().norm(); }
  void place(const sim::BodyState& state);
  const sim::Vector3& target_W() const { return target_W_; }

 private:
  sim::Vector3 to_target() const { return target_W_ - simulation_.truth().body.p_W; }
  sim::Vector3 draw_in_ball(double radius);
  void next_waypoint();

  const TaskConfig& task_;
  ActionMap map_;
  std::uint64_t seed_;
  flight::Simulation simulation_;
  std::shared_ptr<const flight::Simulation::Moment> armed_;
  std::vector<double> hovering_;  ///< States of rotors and battery.
  sim::RandomStream random_;
  sim::Vector3 target_W_{sim::Vector3::Zero()};
  sim::Vector3 next_W_{sim::Vector3::Zero()};
  Action action_{};
  int steps_{0};  ///< Steps of 2.5 ms in this episode.
  std::size_t reached_{0};
};

}  // namespace rosflight::python
