// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/fixedwing/flight_manager.hpp"
#include "autonomy/multirotor/flight_manager.hpp"
#include "autonomy/quadplane/flight_manager.hpp"
#include "link/messages.hpp"

namespace rosflight::flight {

/// Output of guidance in one step, for any vehicle.
struct GuidanceOutput {
  autonomy::FirmwareCommand command{};
  const char* phase{"disarmed"};
  bool idle{true};                              ///< Before take-off or after landing.
  bool in_air{};                                ///< Meant to be off the ground.
  bool coming_down{};                           ///< Landing.
  bool tracking{};                              ///< On the mission's path, holding all axes.
  autonomy::multirotor::Trajectory setpoint{};  ///< Where the vehicle is meant to be,
  bool on_path{true};                           ///< on a path; else `setpoint` is an earlier one.
  std::size_t waypoint{};                       ///< Index of the next one.
  double distance_m{};                          ///< Distance from it.
  bool mission_done{};
  bool landed{};
  bool request_disarm{};
};

/// Guidance and control of one vehicle on one mission.
class Guidance {
 public:
  struct Input {
    double t_s{};  ///< Companion time.
    const autonomy::StateEstimate& state;
    autonomy::Status status{};
    std::optional<double> range_m;   ///< Downward range, if fresh and in range.
    std::span<const float> outputs;  ///< Reported by the flight controller, if fresh.
    // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers name members
    autonomy::RawMotion raw{};  ///< Of the flight controller, for a flight without a state.
  };
  struct Note {
    link::Severity severity{};
    std::string text;
  };
  using Notify = std::function<void(const Note&)>;

  Guidance() = default;
  Guidance(const Guidance&) = delete;
  Guidance& operator=(const Guidance&) = delete;
  virtual ~Guidance() = default;

  /// Called at 100 Hz from arming on. Calls `notify` for each event of the step.
  virtual const GuidanceOutput& step(const Input& in, const Notify& notify) = 0;
  /// Ends the mission: the next steps land.
  virtual void request_land() = 0;
  /// Ends the mission: the next steps fly back and land. Default: land.
  virtual void request_return() { request_land(); }
  /// A step of the commanded altitude: the mission this much higher; 0: as it is. Default: it does not.
  virtual void set_altitude_offset(double /*offset_m*/) {}
  /// Takes other gains and limits into use, in flight. @returns false: it cannot.
  virtual bool configure(const autonomy::multirotor::FlightConfig& /*config*/) { return false; }
  virtual bool configure(const autonomy::fixedwing::FlightConfig& /*config*/) { return false; }
  /// Output of the last step.
  const GuidanceOutput& output() const { return out_; }

 protected:
  GuidanceOutput out_{};
};

/// The project's guidance of a multirotor.
class MultirotorGuidance final : public Guidance {
 public:
  /// @param law  controller that follows the trajectory; nullptr: the project's.
  MultirotorGuidance(const autonomy::multirotor::FlightConfig& config,
                     const autonomy::multirotor::Mission& mission,
                     std::unique_ptr<autonomy::multirotor::TrajectoryLaw> law = nullptr)
      : manager_{config, mission, std::move(law)} {}
  const GuidanceOutput& step(const Input& in, const Notify& notify) override;
  void request_land() override { manager_.request_land(); }
  void request_return() override { manager_.request_return(); }
  void set_altitude_offset(double offset_m) override { manager_.set_altitude_offset(offset_m); }
  using Guidance::configure;
  bool configure(const autonomy::multirotor::FlightConfig& config) override {
    manager_.configure(config);
    return true;
  }
  autonomy::multirotor::FlightManager& manager() { return manager_; }

 private:
  autonomy::multirotor::FlightManager manager_;
};

/// The project's guidance of a fixed wing.
class FixedWingGuidance final : public Guidance {
 public:
  FixedWingGuidance(const autonomy::fixedwing::FlightConfig& config,
                    const autonomy::fixedwing::Mission& mission)
      : manager_{config, mission} {}
  const GuidanceOutput& step(const Input& in, const Notify& notify) override;
  void request_land() override { manager_.request_land(); }
  void request_return() override { manager_.request_return(); }
  using Guidance::configure;
  bool configure(const autonomy::fixedwing::FlightConfig& config) override {
    manager_.configure(config);
    return true;
  }
  autonomy::fixedwing::FlightManager& manager() { return manager_; }
  const autonomy::fixedwing::FlightManager& manager() const { return manager_; }
  const autonomy::fixedwing::FlightOutput& details() const { return manager_.output(); }

 private:
  autonomy::fixedwing::FlightManager manager_;
};

/// The project's guidance of a quad-plane.
class QuadplaneGuidance final : public Guidance {
 public:
  QuadplaneGuidance(const autonomy::quadplane::FlightConfig& config,
                    const autonomy::quadplane::Mission& mission)
      : manager_{config, mission} {}
  const GuidanceOutput& step(const Input& in, const Notify& notify) override;
  void request_land() override { manager_.request_land(); }
  void request_return() override { manager_.request_return(); }
  const autonomy::quadplane::FlightOutput& details() const { return manager_.output(); }

 private:
  autonomy::quadplane::FlightManager manager_;
};

}  // namespace rosflight::flight
