// SPDX-License-Identifier: BSD-3-Clause
#include "flight/simulation.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "flight/autopilot/in_process_autopilot.hpp"
#include "flight/companion_parts.hpp"
#include "flight/quiet_codec.hpp"
#include "flight/world.hpp"
#include "link/detect/detecting_codec.hpp"
#include "sim/lock_step.hpp"
#include "sim/sensors/standard_sensors.hpp"
#include "sim/time_sources.hpp"

namespace rosflight::flight {
namespace {

/// Stands where a mission runner wants guidance: it is used up to arming alone.
class NoGuidance final : public Guidance {
 public:
  const GuidanceOutput& step(const Input& /*in*/, const Notify& /*notify*/) override {
    return out_;
  }
  void request_land() override {}
};

/// An object with references, which cannot be assigned, becomes a copy of another one in its place.
template <class T>
void replace(T& object, const T& by) {
  std::destroy_at(&object);
  std::construct_at(&object, by);
}

/// The module has the faults of no schedule: those in force are set again in the next step.
void heal(sim::ForcesAndMoments& forces) {
  for (std::size_t k = 0; k < sim::kMaxRotors; ++k) {
    forces.set_thrust_factor(k, 1.0);
    forces.set_surface_stuck(k, false);
  }
  forces.set_charge_limit(1.0);
}

void check(const FlightSetup& setup) {
  const FlightChoice& choice = setup.choice;
  if (choice.physics != FlightChoice{}.physics) {
    throw config::Error(
        fmt::format("--physics: found {} in a simulation with snapshots, allowed {}",
                    choice.physics, FlightChoice{}.physics));
  }
  if (!setup.vehicle.world_sensors().keys().empty()) {
    throw setup.vehicle.world_sensors().error("sensors in a simulation with snapshots",
                                              "none; ./rosflight fly has them");
  }
  if (choice.board == "in_process" && choice.link == "cable") return;
  throw config::Error(fmt::format("--board: found {} with --link {}, allowed in_process and cable",
                                  choice.board, choice.link));
}

}  // namespace

class Simulation::Loop final : public World, private sim::LockStepListener {
 public:
  explicit Loop(const FlightSetup& flight_setup)
      : World{(check(flight_setup), flight_setup)},
        autopilot{cable,
                  [this] {
                    return board_codec = std::make_shared<QuietCodec>(setup.choice.link_protocol);
                  }},
        session{codec, autopilot.link(), companion::Session::Options{}},
        estimator{make_link_estimator(setup, session)},
        lock_step{fast, rc, sensors, autopilot, dynamics} {
    lock_step.set_listener(this);
    if (setup.winged()) sensors.set_pitot_covered(true);
    autopilot.start(lock_step.now());
  }

  /// nullptr: a module of a plugin.
  sim::sensors::StandardSensors* instruments() {
    return dynamic_cast<sim::sensors::StandardSensors*>(healthy_sensors.get());
  }

  std::shared_ptr<QuietCodec> board_codec;  ///< That of the firmware's last boot.
  bool linked{true};
  sim::ExternalWrench* external_wrench{nullptr};
  InProcessAutopilot autopilot;
  link::DetectingCodec codec;
  companion::Session session;
  std::unique_ptr<LinkStateEstimator> estimator;
  std::unique_ptr<MissionRunner> runner;  ///< During start() alone.
  sim::LockStepTime fast{kStep};
  sim::LockStep lock_step;

 private:
  void before_step(sim::Time t) override {
    cable.set_time(t);
    apply_faults(t, autopilot);
    if (!linked || faults.active(sim::FaultKind::kCompanionStall, t)) return;
    if (runner != nullptr) {
      runner->step(t, dynamics.truth());
    } else {
      session.step(t);
    }
  }
};

class Simulation::Moment {
 public:
  explicit Moment(Loop& loop)
      : owner_{&loop},
        dynamics_{loop.dynamics},
        instruments_{*loop.instruments()},
        faults_{loop.faults},
        sensors_{loop.sensors},
        pilot_{loop.pilot},
        broken_down_{loop.broken_down},
        autopilot_{loop.autopilot.save()},
        board_codec_{loop.board_codec},
        board_codec_state_{*loop.board_codec},
        link_{loop.linked ? std::make_unique<const Link>(loop) : nullptr},
        lock_step_{loop.lock_step} {}

  const Loop* owner() const { return owner_; }

  void restore(Loop& loop) const {
    replace(loop.dynamics, dynamics_);
    loop.dynamics.set_external_wrench(loop.external_wrench);
    *loop.instruments() = instruments_;
    loop.faults = faults_;
    heal(*loop.forces);
    replace(loop.sensors, sensors_);
    loop.pilot = pilot_;
    loop.broken_down = broken_down_;
    loop.autopilot.restore(autopilot_);
    restore_codec(loop);
    loop.linked = link_ != nullptr;
    if (link_ != nullptr) link_->restore(loop);
    replace(loop.lock_step, lock_step_);
  }

  void restore_firmware(Loop& loop) const {
    loop.autopilot.restore(autopilot_, lock_step_.now(), loop.lock_step.now());
    restore_codec(loop);
    board_codec_->set_quiet(!loop.linked);
    loop.pilot = pilot_;
  }

 private:
  /// Cable and companion: a large part of a moment.
  class Link {
   public:
    explicit Link(Loop& loop)
        : cable_{loop.cable.cable()},
          time_{loop.cable.time()},
          noise_{loop.link_noise},
          codec_{loop.codec},
          session_{loop.codec, loop.autopilot.link(), companion::Session::Options{}},
          estimator_{loop.estimator->save()} {
      session_.copy_state_of(loop.session);
    }
    void restore(Loop& loop) const {
      loop.cable.cable() = cable_;
      loop.cable.set_time(time_);
      loop.link_noise = noise_;
      loop.codec = codec_;
      loop.session.copy_state_of(session_);
      loop.estimator->restore(estimator_);
    }

   private:
    sim::SerialCable cable_;
    sim::Time time_;
    double noise_;
    link::DetectingCodec codec_;
    companion::Session session_;  ///< Is never stepped.
    LinkStateEstimator::Moment estimator_;
  };

  void restore_codec(Loop& loop) const {
    loop.board_codec = board_codec_;
    *board_codec_ = board_codec_state_;
  }

  const Loop* owner_;
  sim::RigidBody dynamics_;
  sim::sensors::StandardSensors instruments_;
  sim::FaultSchedule faults_;
  sim::FaultySensors sensors_;
  sim::rc::Pilot pilot_;
  std::array<bool, 2> broken_down_;
  InProcessAutopilot::Moment autopilot_;
  std::shared_ptr<QuietCodec> board_codec_;  ///< The same object.
  QuietCodec board_codec_state_;
  std::unique_ptr<const Link> link_;  ///< nullptr: there was none.
  sim::LockStep lock_step_;
};

Simulation::Simulation(const FlightSetup& setup) : loop_{std::make_unique<Loop>(setup)} {}
Simulation::~Simulation() = default;

void Simulation::start(const std::function<bool()>& stop) {
  MissionRunnerConfig config = runner_config(setup());
  config.on_truth = false;
  NoGuidance guidance;
  loop_->runner = std::make_unique<MissionRunner>(config, loop_->session, loop_->pilot, guidance,
                                                  *loop_->estimator);
  while (loop_->runner->stage() < Stage::kFly && !(stop && stop())) {
    loop_->sensors.set_pitot_covered(setup().winged() && loop_->runner->stage() < Stage::kArm);
    loop_->lock_step.step();
  }
  const std::unique_ptr<MissionRunner> runner = std::move(loop_->runner);
  if (runner->stage() == Stage::kFailed) throw Error("start: " + runner->failure());
  // The firmware holds the motors at idle at first.
  while (now() < runner->armed_at() + MissionRunner::kTakeOff && !(stop && stop())) step();
}

void Simulation::step() {
  loop_->lock_step.step();
  // What the owner sends between two steps leaves at the start of the next one.
  loop_->cable.set_time(now());
}
sim::Time Simulation::now() const {
  return loop_->lock_step.now();
}
const FlightSetup& Simulation::setup() const {
  return loop_->setup;
}
const sim::Truth& Simulation::truth() const {
  return loop_->dynamics.truth();
}
const hal::OutputValues& Simulation::outputs() const {
  return loop_->autopilot.outputs();
}
autonomy::StateEstimate Simulation::estimate() const {
  return loop_->estimator->estimate();
}
FirmwareView Simulation::view() const {
  return loop_->autopilot.view();
}
const core::Firmware& Simulation::firmware() const {
  return loop_->autopilot.firmware();
}
companion::Session& Simulation::session() {
  return loop_->session;
}
sim::rc::Pilot& Simulation::pilot() {
  return loop_->pilot;
}
sim::FaultSchedule& Simulation::faults() {
  return loop_->faults;
}
void Simulation::set_wind(const sim::Vector3& steady_W_m_s, double w20_m_s) {
  loop_->dynamics.set_wind(steady_W_m_s, w20_m_s, loop_->random);
}
void Simulation::add_gust(const sim::Vector3& peak_W_m_s, double duration_s) {
  loop_->dynamics.add_gust(peak_W_m_s, duration_s);
}
bool Simulation::set_state(const sim::BodyState& state) {
  const std::span<const double> now = module_state();
  return set_state(state, std::vector<double>(now.begin(), now.end()));
}
bool Simulation::set_state(const sim::BodyState& state, std::span<const double> module_state) {
  return loop_->dynamics.set_state(state, module_state);
}
std::span<const double> Simulation::module_state() const {
  return loop_->dynamics.module_state();
}
void Simulation::set_held(bool held) {
  loop_->dynamics.set_held(held);
}

void Simulation::set_external_wrench(sim::ExternalWrench* external) {
  loop_->external_wrench = external;
  loop_->dynamics.set_external_wrench(external);
}

void Simulation::drop_link() {
  loop_->linked = false;
  loop_->board_codec->set_quiet(true);
  // Nothing crosses the cable from here on, and its queues are a third of the memory.
  sim::SerialLine::Config none;
  none.transmit_capacity_bytes.fill(1);
  none.receive_capacity_bytes = 1;
  loop_->cable.cable() = sim::SerialCable{none, loop_->random};
}
void Simulation::tell(const link::Message& message) {
  loop_->autopilot.tell(message, loop_->lock_step.now());
}
void Simulation::restore_firmware(const Moment& moment) {
  if (moment.owner() != loop_.get()) throw Error("restore: the snapshot is of another simulation");
  if (loop_->linked) throw Error("restore: the firmware alone can be restored without a link only");
  moment.restore_firmware(*loop_);
}

std::shared_ptr<const Simulation::Moment> Simulation::save() const {
  if (loop_->instruments() == nullptr)
    throw Error("snapshot: the sensors are a plugin's, which cannot be copied");
  if (!loop_->session.idle())
    throw Error("snapshot: a parameter or a command is under way on the link");
  return std::make_shared<const Moment>(*loop_);
}

void Simulation::restore(const Moment& moment) {
  if (moment.owner() != loop_.get()) throw Error("restore: the snapshot is of another simulation");
  if (!loop_->session.idle())
    throw Error("restore: a parameter or a command is under way on the link");
  moment.restore(*loop_);
}

}  // namespace rosflight::flight
