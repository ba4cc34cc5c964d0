// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/fly/guide.hpp"
#include "apps/fly/navigator.hpp"
#include "companion/session.hpp"
#include "sim/modules.hpp"
#include "sim/rc/pilot.hpp"

namespace rosflight::apps {

/// Where a flight is, from power-up to power-down.
enum class Stage : std::uint8_t {
  kConnect,    ///< Waiting for the firmware to be heard and its parameters to be known.
  kConfigure,  ///< Loading the vehicle's firmware parameters.
  kCalibrate,  ///< IMU at rest.
  kStore,      ///< Writing the parameters to the firmware's memory.
  kArm,        ///< The pilot's switch.
  kFly,        ///< Mission, landing included.
  kDisarm,
  kDone,
  kFailed,
};
const char* stage_name(Stage stage);

struct DirectorConfig {
  companion::ParameterSet firmware;  ///< Parameters of this vehicle.
  sim::Time step{2500};              ///< Of the loop.
  int autonomy_every{4};             ///< Autonomy runs every so many steps.
  double longest_flight_s{600.0};    ///< From arming; then the flight has failed.
  double hover_stick{0.5};           ///< Throttle stick that holds the vehicle in the air.
  bool calibrate_airspeed{false};    ///< There is a pitot tube, and it is covered.
  bool use_range{true};              ///< Guidance is given the range sensor.
  bool share_attitude{true};         ///< The estimated attitude goes to the firmware's filter.
  bool on_truth{false};              ///< Guidance is given the true state.
};

/// What the world shall do at a named moment of the flight; used by tests to play the pilot.
struct DirectorNote {
  sim::Time t{};
  std::string source;  ///< "director", "autonomy", "fcu", "pilot".
  link::Severity severity{link::Severity::kInfo};
  std::string text;
};

/// The companion computer and the pilot's thumbs: brings the firmware up through its own link and
/// radio, flies the mission with offboard commands, lands, disarms. Knows nothing that a real
/// companion would not, unless it is told to fly on the truth. The pilot and the referee, who end a
/// flight that cannot go on, see the vehicle itself.
class FlightDirector final : private companion::Listener {
 public:
  using Notify = std::function<void(const DirectorNote&)>;

  FlightDirector(const DirectorConfig& config, companion::Session& session, sim::rc::Pilot& pilot,
                 Guide& guide, Navigator& navigator);
  ~FlightDirector() override;

  void set_notify(Notify notify) { notify_ = std::move(notify); }

  /// Once per step, at its beginning.
  void step(sim::Time t, const sim::Truth& truth);

  Stage stage() const { return stage_; }
  bool finished() const { return stage_ == Stage::kDone || stage_ == Stage::kFailed; }
  const std::string& failure() const { return failure_; }
  sim::Time armed_at() const { return armed_at_; }
  bool disarmed() const { return disarmed_; }
  /// The offboard commands stop (a companion that hangs); for tests.
  void set_mute(bool mute) { mute_ = mute; }

  struct Arrival {
    bool reached{false};
    double distance_m{0.0};
    double t_s{0.0};
  };
  /// One per waypoint of the mission.
  const std::vector<Arrival>& arrivals() const { return arrivals_; }
  const GuideOutput& output() const { return guide_.output(); }
  /// Of the last step of guidance.
  const autonomy::StateEstimate& estimate() const { return estimate_; }

 private:
  void on_event(const companion::Event& event) override;
  void connect();
  void configure();
  void calibrate();
  void store();
  void arm();
  void fly(const sim::Truth& truth);
  void look(const sim::Truth& truth);
  void watch_the_estimate();
  void share_the_attitude();
  void disarm();
  void ask_for_counters();
  void keep_thumb_ready(const sim::Truth& truth);
  void watch_for_the_end(const sim::Truth& truth);
  void enter(Stage stage);
  void fail(const std::string& why);
  void note(link::Severity severity, const char* source, const std::string& text);
  std::optional<double> range() const;
  void take(const Guide::Note& said);

  DirectorConfig config_;
  companion::Session& session_;
  sim::rc::Pilot& pilot_;
  Guide& guide_;
  Navigator& navigator_;
  autonomy::StateEstimate estimate_;
  std::uint64_t resets_seen_{0};
  autonomy::Trust horizontal_seen_{autonomy::Trust::kGood};
  bool heading_seen_{true};
  Notify notify_;
  sim::Time now_{};
  sim::Time entered_{};
  sim::Time armed_at_{};
  Stage stage_{Stage::kConnect};
  sim::Time grounded_since_{};
  sim::Time heard_{};
  sim::Time asked_{};  ///< For the firmware's counters.
  int countdown_{0};
  float thumb_{0.0F};
  bool mute_{false};
  bool disarmed_{false};
  bool airspeed_calibrated_{false};
  std::string failure_;
  std::vector<Arrival> arrivals_;
  companion::Job<companion::LoadReport> load_;
  companion::Job<companion::CommandResult> command_;
};

}  // namespace rosflight::apps
