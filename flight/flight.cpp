// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "flight/autopilot/chip_autopilot.hpp"
#include "flight/autopilot/in_process_autopilot.hpp"
#include "flight/autopilot/uart_autopilot.hpp"
#include "flight/companion_parts.hpp"
#include "flight/contact_watch.hpp"
#include "flight/tuning.hpp"
#include "flight/world.hpp"
#include "link/detect/detecting_codec.hpp"
#include "sim/lock_step.hpp"
#include "sim/sensors/standard_sensors.hpp"
#include "sim/time_sources.hpp"

namespace rosflight::flight {
namespace {

std::unique_ptr<Guidance> make_guidance(const FlightSetup& setup) {
  if (const auto* fixedwing = std::get_if<FixedWingPlan>(&setup.plan)) {
    return std::make_unique<FixedWingGuidance>(fixedwing->autonomy.flight, fixedwing->mission);
  }
  if (const auto* quadplane = std::get_if<QuadplanePlan>(&setup.plan)) {
    return std::make_unique<QuadplaneGuidance>(quadplane->autonomy.flight, quadplane->mission);
  }
  const auto& rotors = std::get<MultirotorPlan>(setup.plan);
  return std::make_unique<MultirotorGuidance>(rotors.autonomy.flight, rotors.mission);
}

std::unique_ptr<Autopilot> make_autopilot(const FlightSetup& setup, CableLink& link) {
  const std::string& board = setup.choice.board;
  if (board == "in_process") {
    return std::make_unique<InProcessAutopilot>(link, setup.choice.link_protocol);
  }
  if (board != "qemu_m7") {
    const auto receiver = static_cast<hal::ReceiverType>(firmware_value(setup.firmware, "RC_TYPE"));
    const ChipCables cables{setup.choice.link == "usb", receiver == hal::ReceiverType::kCrsf};
    return std::make_unique<ChipAutopilot>(link, emulated_chip(board), cables);
  }
  EmulatedAutopilot::Emulator::Options options;
  options.image = emulated_image(setup.choice.link_protocol);
  if (setup.choice.link == "uart") {
    options.coupling = boards::m7::Coupling::kRealTime;
    return std::make_unique<UartAutopilot>(link.time(), options);
  }
  return std::make_unique<EmulatedAutopilot>(link, options);
}

}  // namespace

/// Owns the modules in the order of their construction and takes part in each step.
class Flight::Loop final : public World, private sim::LockStepListener {
 public:
  Loop(Flight& owner, const FlightSetup& flight_setup, FlightParts parts)
      : World{flight_setup, std::move(parts.engine)},
        flight{owner},
        autopilot{parts.autopilot ? parts.autopilot(cable) : make_autopilot(setup, cable)},
        session{codec, autopilot->link(), companion::Session::Options{}},
        guidance{parts.guidance ? std::move(parts.guidance) : make_guidance(setup)},
        estimate_source{parts.estimate_source ? parts.estimate_source(session)
                                              : make_link_estimator(setup, session)},
        runner{runner_config(setup), session, pilot, *guidance, *estimate_source},
        scorer{setup},
        lock_step{parts.time != nullptr ? *parts.time : fast, rc, sensors, *autopilot, dynamics} {
    lock_step.set_listener(this);
    lock_step.set_substeps(autopilot->substeps(), kStep / autopilot->substeps());
    for (const std::string& name : setup.choice.visualisers) {
      visualisers.push_back(setup.registry.visualisers.at(name)(setup.vehicle, random));
      lock_step.add(*visualisers.back());
    }
    if (const auto* plan = std::get_if<FixedWingPlan>(&setup.plan)) {
      fixedwing_guidance = dynamic_cast<const FixedWingGuidance*>(guidance.get());
      fixedwing_record.emplace(plan->mission.landing.aim_W,
                               plan->autonomy.mission.plan_for(plan->mission).radius_m);
    }
    instruments = dynamic_cast<const sim::sensors::StandardSensors*>(healthy_sensors.get());
    autopilot->start(lock_step.now());
  }

  sim::Vector3 seen_position_W() const;
  const std::optional<hal::ImuSample>& newest_imu();

  Flight& flight;
  std::unique_ptr<Autopilot> autopilot;
  link::DetectingCodec codec;
  companion::Session session;
  std::unique_ptr<Guidance> guidance;
  std::unique_ptr<StateEstimateSource> estimate_source;
  MissionRunner runner;
  FlightScorer scorer;
  ContactWatch contacts;
  sim::Time failed_at{};  ///< 0: not yet.
  sim::LockStepTime fast{kStep};
  sim::LockStep lock_step;
  std::vector<std::unique_ptr<sim::Visualiser>> visualisers;  ///< Those the setup names.
  std::function<void(Flight&, sim::Time)> script;
  WorldReceiver world_receiver;
  std::string vehicle_text{setup.vehicle.text()};
  ErrorStatistics tracking;
  ErrorStatistics own_tracking;
  std::optional<hal::ImuSample> imu;
  /// nullptr unless the project's guidance flies a fixed wing.
  const FixedWingGuidance* fixedwing_guidance{};
  std::optional<FixedWingRecord> fixedwing_record;
  std::optional<sim::Vector3> frame_shift_W;           ///< Shift of the estimated frame [m].
  const sim::sensors::StandardSensors* instruments{};  ///< nullptr: a module of a user's own.

 private:
  void before_step(sim::Time t) override;
  void note_frame_of_estimate();
  void note_contact(sim::Time t);
  void receive(sim::Time t, const std::string& name, const sim::WorldSample& sample);
};

void Flight::Loop::before_step(sim::Time t) {
  if (lock_step.samples().has_imu) imu = lock_step.samples().imu;
  cable.set_time(t);
  if (engine) note_contact(t);
  apply_faults(t, *autopilot);
  world_sensors.step(dynamics.truth(), [this, t](const std::string& name, const auto& sample) {
    receive(t, name, sample);
  });
  if (!faults.active(sim::FaultKind::kCompanionStall, t)) runner.step(t, dynamics.truth());
  note_frame_of_estimate();
  if (runner.stage() >= Stage::kFly)
    scorer.step(dynamics.truth(), runner.estimate().p_W, guidance->output());
  if (failed_at == sim::Time{0} && runner.stage() == Stage::kFailed) failed_at = t;
  const GuidanceOutput& output = guidance->output();
  if (output.tracking && runner.stage() == Stage::kFly) {
    tracking.add((dynamics.truth().body.p_W - output.setpoint.p_W).norm());
    own_tracking.add((seen_position_W() - output.setpoint.p_W).head<2>().norm());
  }
  if (setup.winged()) sensors.set_pitot_covered(runner.stage() < Stage::kArm);
  if (setup.winged() && runner.stage() == Stage::kFly) {
    dynamics.set_held(guidance->output().idle && !guidance->output().landed);
    if (fixedwing_guidance != nullptr) {
      fixedwing_record->step(dynamics.truth(), seen_position_W(), fixedwing_guidance->details());
    }
  }
  if (script) script(flight, t);
}

/// The companion computer has them at once; their delay is that of the sensor.
void Flight::Loop::receive(sim::Time t, const std::string& name, const sim::WorldSample& sample) {
  if (const auto* pose = std::get_if<sim::PoseSample>(&sample)) {
    if (faults.active(sim::FaultKind::kMotionCapture, t)) return;
    estimate_source->add(*pose);
  }
  if (world_receiver) world_receiver(t, name, sample);
}

/// Bodies of the world that the engine knows; a crash ends the mission.
void Flight::Loop::note_contact(sim::Time t) {
  const std::optional<sim::PhysicsEngine::Contact> contact = dynamics.take_contact();
  if (!contact) return;
  const std::optional<ContactWatch::Event> event = contacts.step(t, *contact);
  if (!event) return;
  runner.report(event->crash ? link::Severity::kError : link::Severity::kInfo, "world",
                event->text);
  if (!event->crash) return;
  scorer.crash(event->text);
  runner.abort("crash: " + event->text);
}

sim::Vector3 Flight::Loop::seen_position_W() const {
  return dynamics.truth().body.p_W + frame_shift_W.value_or(sim::Vector3::Zero());
}

/// With the first fixes the estimate places its frame on the map: off by the error of the satellites
/// at that moment, unless its origin comes from these fixes too.
void Flight::Loop::note_frame_of_estimate() {
  const auto& origin = estimate_source->origin();
  if (frame_shift_W || !origin || instruments == nullptr || setup.choice.state == "truth") return;
  frame_shift_W =
      instruments->gnss_bias() - autonomy::ned_of(*origin, setup.vehicle.environment().origin);
}

/// In the step under way the autopilot may have received it, or not yet: a tap that asks is called
/// by the autopilot.
const std::optional<hal::ImuSample>& Flight::Loop::newest_imu() {
  if (lock_step.samples().has_imu) imu = lock_step.samples().imu;
  return imu;
}

Flight::Flight(const FlightSetup& setup, FlightParts parts)
    : loop_{std::make_unique<Loop>(*this, setup, std::move(parts))} {}
Flight::~Flight() = default;

void Flight::set_tap(LinkTap* tap) {
  loop_->autopilot->set_link_tap(tap);
}
void Flight::add(sim::Visualiser& visualiser) {
  loop_->lock_step.add(visualiser);
}
void Flight::set_script(std::function<void(Flight&, sim::Time)> script) {
  loop_->script = std::move(script);
}
void Flight::set_world_receiver(WorldReceiver receiver) {
  loop_->world_receiver = std::move(receiver);
}
const sim::WorldSensors& Flight::world_sensors() const {
  return loop_->world_sensors;
}
void Flight::step() {
  loop_->lock_step.step();
}
sim::PhysicsEngine::Load Flight::begin_step() {
  if (loop_->autopilot->substeps() != 1)
    throw std::logic_error("a step in two halves of a board with substeps");
  loop_->lock_step.begin_step();
  return loop_->dynamics.begin_step(loop_->lock_step.now(), loop_->lock_step.outputs());
}
void Flight::end_step() {
  loop_->dynamics.end_step(loop_->lock_step.now(), loop_->lock_step.outputs());
  loop_->lock_step.end_step();
}
void Flight::run() {
  while (!finished()) loop_->lock_step.step();
}
bool Flight::finished() const {
  if (loop_->runner.stage() != Stage::kFailed) return loop_->runner.finished();
  constexpr double kDown_s = 1.0;
  const LandingScore& landing = loop_->scorer.landing();
  return !landing.airborne() || landing.down_for_s() >= kDown_s ||
         now() - loop_->failed_at >= kAfterFailure;
}
FlightScore Flight::score(bool interrupted) const {
  return loop_->scorer.score(loop_->runner, autonomy().landed, interrupted);
}

sim::Time Flight::now() const {
  return loop_->lock_step.now();
}
const FlightSetup& Flight::setup() const {
  return loop_->setup;
}
const std::string& Flight::world_sha256() const {
  return loop_->world_sha256;
}
const sim::Truth& Flight::truth() const {
  return loop_->dynamics.truth();
}
const sim::RigidBody& Flight::dynamics() const {
  return loop_->dynamics;
}
MissionRunner& Flight::runner() {
  return loop_->runner;
}
const MissionRunner& Flight::runner() const {
  return loop_->runner;
}
Autopilot& Flight::autopilot() {
  return *loop_->autopilot;
}
const Autopilot& Flight::autopilot() const {
  return *loop_->autopilot;
}
InProcessAutopilot& Flight::in_process() {
  return dynamic_cast<InProcessAutopilot&>(*loop_->autopilot);
}
const std::optional<hal::ImuSample>& Flight::imu() const {
  return loop_->newest_imu();
}
companion::Session& Flight::session() {
  return loop_->session;
}
sim::rc::Pilot& Flight::pilot() {
  return loop_->pilot;
}
Guidance& Flight::guidance() {
  return *loop_->guidance;
}
const Guidance& Flight::guidance() const {
  return *loop_->guidance;
}
const std::string& Flight::vehicle_text() const {
  return loop_->vehicle_text;
}
void Flight::tune(const TunedVehicle& vehicle) {
  const bool done =
      std::visit([this](const auto& autonomy) { return guidance().configure(autonomy.flight); },
                 vehicle.autonomy);
  if (!done) throw config::Error("tune: found a guidance of a plugin, allowed the project's");
  loop_->vehicle_text = vehicle.text;
}
sim::FaultSchedule& Flight::faults() {
  return loop_->faults;
}
void Flight::set_wind(const sim::Vector3& steady_W_m_s, double w20_m_s) {
  loop_->dynamics.set_wind(steady_W_m_s, w20_m_s, loop_->random);
}
void Flight::add_gust(const sim::Vector3& peak_W_m_s, double duration_s) {
  loop_->dynamics.add_gust(peak_W_m_s, duration_s);
}
const StateEstimateSource& Flight::estimate_source() const {
  return *loop_->estimate_source;
}
const ErrorStatistics& Flight::tracking() const {
  return loop_->tracking;
}
const ErrorStatistics& Flight::own_tracking() const {
  return loop_->own_tracking;
}
const FixedWingRecord* Flight::fixedwing_record() const {
  const auto& record = loop_->fixedwing_record;
  return record ? &*record : nullptr;
}
sim::Vector3 Flight::seen_position_W() const {
  return loop_->seen_position_W();
}

}  // namespace rosflight::flight
