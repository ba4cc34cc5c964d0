// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flight/simulation.hpp"
#include "python/src/action_map.hpp"
#include "python/src/task.hpp"

namespace rosflight::python {

/// How a learner is connected to its vehicle, and what it sees.
struct Connection {
  /// "truth"; "estimate": the companion's; "sensors": the estimate, then kSensorNumbers of what arrived last; "firmware":
  /// what the firmware's learned controller gets.
  std::string observation{"truth"};
  /// Commands and telemetry are bytes on the cable, and the companion estimates.
  bool link{false};
  std::string action{"rates"};  ///< What actions mean: ActionMap.
  int substeps{4};              ///< Steps of 2.5 ms in an action.
  int delay_steps{0};           ///< Steps from an action to the board.
};
/// Gyro 3 [rad/s], accelerometer 3 [m/s^2], magnetometer 3 [uT], barometer [m], range [m], airspeed [m/s], velocity by GNSS 3 [m/s].
inline constexpr std::size_t kSensorNumbers = 15;

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
  /// action 4; then those of the task. "firmware": the inputs of core::Policy. @throws config::Error  the task is unknown.
  static std::size_t observation_size(const std::string& task, const std::string& observation) {
    if (observation == "firmware") return core::Policy::kRateInputs;
    constexpr std::size_t kCommon = 22;
    return kCommon + Task::observation_size(task) + (observation == "sensors" ? kSensorNumbers : 0);
  }

  /// @param setup, task  must outlive this. @param known  the vehicle as its companion knows it, of which actions
  ///   are made. @param seed  of its noise and its episodes. @throws config::Error  the vehicle does not have this
  ///   task or action, or a fixed wing that takes off may not fly at the altitude of the task.
  Learner(flight::FlightSetup& setup, const TaskConfig& task, const flight::FlightSetup& known,
          const Connection& connection, std::uint64_t seed);

  /// Powers it up and arms it. Without a link the rotors then turn as in hover, and the link is left out; with one the
  /// companion takes off, and a fixed wing circles then. @throws flight::Simulation::Error  it does not arm, or does not get there.
  void start();
  /// As right after start(): the first episode again.
  void rewind();
  /// A new episode. Without a link the noise of sensors and air goes on, and the vehicle is put where the episode
  /// starts. With one everything is as after the take-off, and the companion flies to the start, or a fixed
  /// wing onto the course of the start.
  void begin_episode();
  Result step(const Action& action);
  void observe(float* out);
  const sim::Truth& truth() const { return simulation_.truth(); }
  const hal::OutputValues& outputs() const { return simulation_.outputs(); }
  std::size_t reached() const { return task_->reached(); }
  double distance_m() const { return to_target(truth().body.p_W).norm(); }

 private:
  sim::Vector3 to_target(const sim::Vector3& p_W) const { return task_->target_W(p_W) - p_W; }
  SeenState seen() const;
  link::OffboardControl command();
  void send(const link::OffboardControl& command);
  void share_attitude();
  void step_once();
  void turn_rotors();
  void take_off();
  void take_off_and_circle();
  void fly_to(const sim::Vector3& p_W, double heading_rad, double near_m);
  void fly_along(double course_rad, double height_m);
  void fly_by_companion(
      double too_long_s,
      const std::function<std::optional<autonomy::FirmwareCommand>(const autonomy::StateEstimate&)>&
          step);
  autonomy::StateEstimate flown_on() const;
  float* observe_sensors(float* to);
  void observe_firmware(const core::CommandVector& angles, float* to) const;

  const TaskConfig& config_;
  Connection connection_;
  std::uint64_t seed_;
  flight::Simulation simulation_;
  std::unique_ptr<Task> task_;
  ActionMap map_;
  std::shared_ptr<const flight::Simulation::Moment> ready_;  ///< What episodes begin from.
  std::vector<double> hovering_;                             ///< States of rotors and battery.
  sim::RandomStream random_;
  Action action_{};
  struct Underway {
    int at_step{};
    link::OffboardControl command;
  };
  std::deque<Underway> underway_;  ///< Commands that are delayed.
  int steps_{0};                   ///< Steps of 2.5 ms in this episode.
};

}  // namespace rosflight::python
