// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "flight/flight_setup.hpp"
#include "python/src/action_map.hpp"
#include "python/src/seen_state.hpp"
#include "sim/random.hpp"
#include "sim/types.hpp"

namespace rosflight::python {

/// What an environment may be told about its task. Positions are in W.
struct TaskConfig {
  std::string task{"hover"};  ///< One of task_names().
  double episode_s{10.0};
  double altitude_m{5.0};  ///< The first target is so high; the middle of waypoints is 1 m higher.
  double start_radius_m{
      1.0};  ///< Start: within this distance of where the task begins, uniform in the ball, ...
  double start_tilt_rad{0.5};  ///< ... tilted by up to this, ...
  double start_speed_m_s{1.0};
  double start_rates_rad_s{1.0};
};

std::vector<std::string> task_names();

/// What a learner is to do and what it is rewarded for. Distances are of the truth.
class Task {
 public:
  struct Verdict {
    double reward{};
    bool lost{};     ///< It failed, which ends the episode.
    bool done{};     ///< Nothing is left to do, which ends it too.
    bool success{};  ///< Whether an episode that ends now is a success.
  };
  struct Start {
    sim::BodyState body;
    std::vector<double>
        module_state;  ///< States of rotors, servos and battery; empty: as in hover.
  };

  /// @param config  must outlive it. @param rest_W  where the vehicle stands on the ground.
  /// @throws config::Error  the task is unknown, or not one of this vehicle; none is of a quad-plane.
  static std::unique_ptr<Task> make(const TaskConfig& config, const flight::FlightSetup& setup,
                                    const sim::Vector3& rest_W);
  /// How many numbers observe() adds. @throws config::Error  the task is unknown.
  static std::size_t observation_size(const std::string& task);
  /// How many numbers an action has. @throws config::Error  the task is unknown.
  static std::size_t action_size(const std::string& task);

  explicit Task(const TaskConfig& config) : config_{config} {}
  virtual ~Task() = default;
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  /// Draws an episode.
  virtual Start begin(sim::RandomStream& random) = 0;
  /// The episode starts there instead, where the companion could not do better.
  virtual void place(const sim::BodyState& body) { static_cast<void>(body); }
  /// The vehicle has moved by one step of the simulation.
  virtual void advance(const sim::Truth& now) { static_cast<void>(now); }
  /// An action has been flown for dt_s. Begins the next one.
  virtual Verdict judge(const sim::Truth& truth, double dt_s) = 0;
  /// Where the vehicle is to go, from `p_W`.
  virtual sim::Vector3 target_W(const sim::Vector3& p_W) const = 0;
  /// What is to be seen of the task beside its target. @returns the end.
  virtual float* observe(const SeenState& seen, float* to) const {
    static_cast<void>(seen);
    return to;
  }
  /// What the firmware receives for an action, where the task commands a part of it itself.
  virtual Action flown(const Action& action) const { return action; }
  /// The angles that are asked for, of a task whose observation is what the firmware's learned controller gets.
  virtual const core::CommandVector* angles() const { return nullptr; }
  /// Waypoints reached or gates passed.
  std::size_t reached() const { return reached_; }

 protected:
  /// The part of every reward that is for a quiet flight.
  static double turning(const sim::Truth& truth, double dt_s);
  /// Cosine of the tilt.
  static double upright(const sim::BodyState& body);
  /// A start about a point of W: the nose within `heading_spread_rad` of `heading_rad`.
  Start draw_start(sim::RandomStream& random, const sim::Vector3& at_W, double heading_rad,
                   double heading_spread_rad) const;
  double distance_m(const sim::Vector3& p_W) const { return (target_W(p_W) - p_W).norm(); }

  const TaskConfig& config_;
  std::size_t reached_{0};
};

}  // namespace rosflight::python
