// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "flight/gazebo/coupling/link_state.hpp"

namespace rosflight::flight::gazebo {

/// What a loop asks of the simulator that runs it.
enum class Run { kPause, kResume, kStop };

/// What the simulator does before it moves the link by one step: sets its state, or applies the wrench.
struct StepCommand {
  std::optional<LinkState> place;  ///< In its step there is no wrench.
  LinkWrench wrench;
  std::optional<Run> run;
};

/// What is closed around one link: called before and after each step of the simulator, in one thread. Knows nothing
/// of Gazebo. Every function may throw: one line, the loop is of no use any more.
class LinkLoop {
 public:
  virtual ~LinkLoop() = default;
  virtual StepCommand before_step(std::chrono::nanoseconds step) = 0;
  /// @param state  at the end of the step.
  virtual void after_step(const LinkState& state) = 0;
  /// In place of both while time stands.
  virtual std::optional<Run> while_paused() { return std::nullopt; }
};

/// Keeps a loop in step with the simulator. What it cannot be in step with, it reports in one line; from then on
/// the link has no wrench and the simulator goes on without the vehicle:
///
/// - a physics step that is no whole part of the firmware's, 2.5 ms;
/// - simulated time that goes back;
/// - a state with a NaN, or none at the end of a step;
/// - whatever the loop throws.
class LinkCoupling {
 public:
  using Say = std::function<void(const std::string& line)>;
  struct Time {
    std::chrono::nanoseconds reached{};  ///< Simulated time at the end of the step.
    std::chrono::nanoseconds step{};
    bool paused{false};
  };

  LinkCoupling(std::unique_ptr<LinkLoop> loop, Say say);

  StepCommand before_step(const Time& time);
  /// @param state  empty: the simulator has none.
  void after_step(const Time& time, const std::optional<LinkState>& state);
  /// false: it has reported something.
  bool works() const { return loop_ != nullptr; }

 private:
  void give_up(const std::string& line);
  bool in_step(const Time& time);

  std::unique_ptr<LinkLoop> loop_;  ///< nullptr: given up.
  Say say_;
  std::optional<std::chrono::nanoseconds> reached_;
  bool stepping_{false};  ///< Between before_step() and after_step().
};

}  // namespace rosflight::flight::gazebo
