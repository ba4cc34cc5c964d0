// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/coupling/whole_loop.hpp"

#include <fmt/format.h>

#include <utility>

#include "flight/flight_recorder.hpp"
#include "flight/gazebo/coupling/link_engine.hpp"

namespace rosflight::flight::gazebo {
namespace {

FlightChoice checked(const FlightChoice& choice) {
  if (choice.board == "in_process" && choice.link == "cable") return choice;
  throw config::Error(fmt::format("board: found {} with link {}, allowed in_process and cable",
                                  choice.board, choice.link));
}

/// The load is that of a whole step.
const FlightSetup& checked(const FlightSetup& setup) {
  const sim::BodyParameters& body = setup.vehicle.body();
  if (body.max_step_s < sim::to_seconds(Flight::kStep))
    throw config::Error(fmt::format("body.max_step_s: found {}, allowed {} or more in Gazebo",
                                    body.max_step_s, sim::to_seconds(Flight::kStep)));
  return setup;
}

}  // namespace

struct WholeLoop::Parts {
  Parts(Options chosen, LinkCoupling::Say line)
      : options{std::move(chosen)}, say{std::move(line)}, setup{checked(options.choice)} {
    const double gravity_m_s2 = checked(setup).vehicle.environment().gravity_m_s2;
    auto made = std::make_unique<LinkEngine>(setup.vehicle.body().mass_kg, gravity_m_s2,
                                             options.centre_of_mass_L);
    engine = made.get();
    FlightParts parts;
    parts.engine = std::move(made);
    flight.emplace(setup, std::move(parts));
    if (!options.log_file.empty()) recorder.emplace(*flight, options.log_file);
    flight->runner().set_notify([this](const FlightNote& note) {
      if (recorder) recorder->note(note);
      if (note.severity <= link::Severity::kWarning || note.source == "mission")
        say(fmt::format("{:.2f} s {}: {}", sim::to_seconds(note.t), note.source, note.text));
    });
  }

  void report();

  Options options;
  LinkCoupling::Say say;
  FlightSetup setup;
  LinkEngine* engine{nullptr};  ///< The flight's.
  std::optional<Flight> flight;
  std::optional<FlightRecorder> recorder;
  sim::PhysicsEngine::Load load;
  sim::Quaternion q_GL{sim::Quaternion::Identity()};  ///< Now.
  std::chrono::nanoseconds step{0};
  std::chrono::nanoseconds done{0};  ///< Part of the firmware's step.
  bool placing{false};               ///< This step puts the vehicle somewhere.
  bool finished{false};
  bool end_asked{false};
};

void WholeLoop::Parts::report() {
  const FlightScore score = flight->score();
  if (recorder) recorder->close();
  say(fmt::format("{} after {:.2f} s: {}", outcome_name(score.outcome),
                  sim::to_seconds(flight->now()), score.verdict));
}

WholeLoop::WholeLoop(Options options, LinkCoupling::Say say)
    : parts_{std::make_unique<Parts>(std::move(options), std::move(say))} {}

WholeLoop::~WholeLoop() {
  if (parts_->recorder && !parts_->finished) {
    try {
      parts_->recorder->close();
    } catch (const std::exception& error) {
      parts_->say(error.what());
    }
  }
}

const Flight& WholeLoop::flight() const {
  return *parts_->flight;
}

StepCommand WholeLoop::before_step(std::chrono::nanoseconds step) {
  Parts& p = *parts_;
  p.step = step;
  StepCommand command;
  if (p.finished) {
    if (!std::exchange(p.end_asked, true)) command.run = p.options.at_end;
    return command;
  }
  if (p.done.count() == 0) {
    command.place = p.engine->take_placing();
    p.placing = command.place.has_value();
    if (p.placing) return command;
    p.load = p.flight->begin_step();
  }
  command.wrench = link_wrench(p.load, p.q_GL, p.engine->centre_of_mass_L());
  return command;
}

void WholeLoop::after_step(const LinkState& state) {
  Parts& p = *parts_;
  p.q_GL = state.q_GL;
  if (p.finished) return;
  if (p.placing) return p.engine->begin(state);
  p.done += p.step;
  constexpr std::chrono::nanoseconds kWhole = Flight::kStep;
  if (p.done < kWhole) return;
  p.done = std::chrono::nanoseconds{0};
  p.engine->move(state, sim::to_seconds(Flight::kStep), p.load);
  p.flight->end_step();
  p.finished = p.flight->finished();
  if (p.finished) p.report();
}

}  // namespace rosflight::flight::gazebo
