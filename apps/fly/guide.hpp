// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/fixedwing/flight_manager.hpp"
#include "autonomy/multirotor/flight_manager.hpp"
#include "link/messages.hpp"

namespace rosflight::apps {

/// What guidance of any vehicle says in one step, as far as director, recorder and tests look.
struct GuideOutput {
  autonomy::FirmwareCommand command{};
  const char* phase{"disarmed"};
  bool idle{true};                  ///< Before take-off or after landing.
  bool in_air{};                    ///< Meant to be off the ground.
  bool coming_down{};               ///< Landing.
  bool tracking{};                  ///< On the mission's path, holding all axes.
  autonomy::Trajectory setpoint{};  ///< Where the vehicle is meant to be.
  std::size_t waypoint{};
  double distance_m{};
  bool mission_done{};
  bool landed{};
  bool request_disarm{};
};

/// Guidance and control of whatever vehicle flies, behind one face.
class Guide {
 public:
  struct Input {
    double t_s{};
    const autonomy::StateEstimate& state;
    autonomy::Status status{};
    std::optional<double> range_m;
  };
  struct Note {
    link::Severity severity{};
    std::string text;
    std::optional<std::size_t> waypoint;  ///< One that was reached or missed, and how.
    bool reached{};
    double distance_m{};
  };
  using Notify = std::function<void(const Note&)>;

  Guide() = default;
  Guide(const Guide&) = delete;
  Guide& operator=(const Guide&) = delete;
  virtual ~Guide() = default;

  virtual const GuideOutput& step(const Input& in, const Notify& notify) = 0;
  virtual void request_land() = 0;
  const GuideOutput& output() const { return out_; }

 protected:
  GuideOutput out_{};
};

class MultirotorGuide final : public Guide {
 public:
  /// @param law  flies the trajectories; none: the one of the project.
  MultirotorGuide(const autonomy::FlightConfig& config, const autonomy::Mission& mission,
                  std::unique_ptr<autonomy::TrajectoryLaw> law = nullptr)
      : manager_{config, mission, std::move(law)} {}
  const GuideOutput& step(const Input& in, const Notify& notify) override;
  void request_land() override { manager_.request_land(); }
  autonomy::FlightManager& manager() { return manager_; }

 private:
  autonomy::FlightManager manager_;
};

class FixedWingGuide final : public Guide {
 public:
  FixedWingGuide(const autonomy::fixedwing::FlightConfig& config,
                 const autonomy::fixedwing::Mission& mission)
      : manager_{config, mission} {}
  const GuideOutput& step(const Input& in, const Notify& notify) override;
  void request_land() override { manager_.request_land(); }
  autonomy::fixedwing::FlightManager& manager() { return manager_; }
  const autonomy::fixedwing::FlightManager& manager() const { return manager_; }
  const autonomy::fixedwing::FlightOutput& details() const { return manager_.output(); }

 private:
  autonomy::fixedwing::FlightManager manager_;
};

}  // namespace rosflight::apps
