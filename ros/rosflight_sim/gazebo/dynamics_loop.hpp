// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <memory>
#include <optional>

#include "flight/gazebo/coupling/link_loop.hpp"
#include "flight/gazebo/coupling/link_truth.hpp"
#include "flight/gazebo/coupling/plugin_options.hpp"
#include "flight/gazebo/coupling/wrench_steps.hpp"
#include "sim/environment/wind.hpp"
#include "sim/vehicle.hpp"

namespace rosflight_sim {

namespace gazebo = rosflight::flight::gazebo;
namespace sim = rosflight::sim;

/// Mode `dynamics_only`: the dynamics node of the simulator with a link of Gazebo for its body. It reads
/// `sim/forces_and_moments`, publishes `sim/truth_state` and `sim/truth_wind` with the stamp of the wrench, and serves
/// `dynamics/set_sim_state` and `dynamics/reset`. All other nodes stay as they are.
///
/// The wrenches lead: Gazebo moves by the time between two stamps, and waits for the next wrench at the beginning of a step. When none
/// comes for `wait`, the last one acts for one more step, which later ones make up for, and Gazebo is paused until there is one. Time
/// that passes while a person has paused Gazebo does not count, and nothing is published then.
///
/// Wind is that of the vehicle file. A state that was asked for is set at the next step; no wrench acts in that step.
class DynamicsLoop final : public gazebo::LinkLoop {
 public:
  /// @param c_L  centre of mass in link axes. @param say  for lines about the whole.
  DynamicsLoop(const sim::Vehicle& vehicle, const gazebo::PluginOptions& options,
               const sim::Vector3& c_L, gazebo::LinkCoupling::Say say);
  ~DynamicsLoop() override;

  gazebo::StepCommand before_step(std::chrono::nanoseconds step) override;
  void after_step(const gazebo::LinkState& state) override;
  std::optional<gazebo::Run> while_paused() override;

 private:
  struct Topics;
  void receive(std::chrono::nanoseconds stamp, const sim::Wrench& wrench);
  /// @returns what is wrong with it; nullptr: it will be set.
  const char* ask(sim::BodyState body);
  void publish();
  void publish_wind();
  void spin(std::chrono::nanoseconds longest);

  const gazebo::PluginOptions options_;
  gazebo::LinkCoupling::Say say_;
  double gravity_m_s2_;
  gazebo::WrenchSteps steps_;
  gazebo::LinkTruth truth_;
  sim::Wind wind_;
  std::chrono::nanoseconds step_{0};        ///< That of Gazebo.
  std::optional<gazebo::LinkState> start_;  ///< The first state that was seen.
  std::optional<gazebo::LinkState> now_;
  std::optional<sim::BodyState> asked_;
  bool due_{false};        ///< The step under way is one of a wrench.
  bool we_paused_{false};  ///< For want of wrenches.
  bool stands_{false};     ///< A person has paused Gazebo.
  bool alone_checked_{false};
  std::optional<sim::Vector3> published_wind_W_;
  int same_winds_{0};
  std::unique_ptr<Topics> topics_;  ///< The last member: its callbacks use the others.
};

}  // namespace rosflight_sim
