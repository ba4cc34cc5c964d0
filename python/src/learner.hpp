// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "flight/simulation.hpp"
#include "python/src/action_map.hpp"
#include "python/src/task.hpp"

namespace rosflight::python {

/// One vehicle and its episodes.
class Learner {
 public:
  struct Result {
    float reward{};
    bool terminated{};
    bool truncated{};
    bool success{};  ///< Whether an episode that has ended was one.
  };

  /// Numbers of an observation: target less position 3, velocity 3, rotation matrix 9 (rows, body to W), rates 3, last
  /// action 4; then those of the task. @throws config::Error  the task is unknown.
  static std::size_t observation_size(const std::string& task) {
    constexpr std::size_t kCommon = 22;
    return kCommon + Task::observation_size(task);
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
  std::size_t reached() const { return task_->reached(); }
  double distance_m() const { return to_target(truth().body.p_W).norm(); }

 private:
  sim::Vector3 to_target(const sim::Vector3& p_W) const { return task_->target_W(p_W) - p_W; }
  link::OffboardControl command();

  const TaskConfig& config_;
  ActionMap map_;
  std::uint64_t seed_;
  flight::Simulation simulation_;
  std::unique_ptr<Task> task_;
  std::shared_ptr<const flight::Simulation::Moment> armed_;
  std::vector<double> hovering_;  ///< States of rotors and battery.
  sim::RandomStream random_;
  Action action_{};
  int steps_{0};  ///< Steps of 2.5 ms in this episode.
};

}  // namespace rosflight::python
