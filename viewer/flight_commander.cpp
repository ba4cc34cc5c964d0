// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/flight_commander.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "config/strict_yaml.hpp"
#include "sim/time_sources.hpp"

namespace rosflight::viewer {
namespace {

using web::server::CommandDesk;
using Notify = flight::MissionRunner::Notify;

constexpr const char* kEnded = "the flight has ended";
constexpr auto kLook = std::chrono::milliseconds(5);

ViewerCommands::ParseChange changes_of(flight::Flight*& flight, Pace& pace) {
  return [&flight, &pace](const std::string& text) {
    return parse_simulation_change(text, *flight, pace);
  };
}

/// Lines of the log name the viewer and the step in which a command enters.
ViewerCommands::Log log_of(const Notify& note, sim::Time now) {
  return [&note, now](std::uint64_t viewer, const std::string& text) {
    note({now, flight::kViewer, link::Severity::kInfo,
          fmt::format("viewer {} {} (step {})", viewer, text, now / flight::Flight::kStep)});
  };
}

/// What a viewer did, without the step.
struct Line {
  std::uint64_t viewer{};
  std::string text;
};

/// "viewer 2 takes control (step 40)": nothing for a line of another form.
std::optional<Line> parse_line(std::string_view line) {
  constexpr std::string_view kStart = "viewer ";
  const std::size_t end = line.rfind(" (step ");
  if (!line.starts_with(kStart) || end == std::string_view::npos) return std::nullopt;
  line = line.substr(kStart.size(), end - kStart.size());
  std::uint64_t viewer{};
  const char* const last = line.data() + line.size();
  const auto [space, error] = std::from_chars(line.data(), last, viewer);
  if (error != std::errc{} || space == last || *space != ' ') return std::nullopt;
  return Line{viewer, std::string(line.substr(static_cast<std::size_t>(space - line.data()) + 1))};
}

}  // namespace

FlightCommander::FlightCommander(CommandDesk& desk, bool hold, std::function<bool()> stopped)
    : desk_{desk},
      hold_{hold},
      stopped_{std::move(stopped)},
      commands_{desk, changes_of(flight_, pace_)} {}

void FlightCommander::begin(sim::PacedTime* pace) {
  time_ = pace;
  pace_.reset.reset();
  commands_.give_control(0);  // taken again, so that the log of this flight has it
  pace_.speed = pace != nullptr ? pace->factor() : 1.0;
}

void FlightCommander::step(flight::Flight& flight, sim::Time now, const Notify& note) {
  flight_ = &flight;
  if (now == sim::Time{0}) choice_ = flight.setup().choice;
  const ViewerCommands::Log log = log_of(note, now);
  if (hold_ && now == sim::Time{0}) {
    // As a viewer would, so that a repeated flight does it too.
    commands_.start({0, {}, CommandDesk::Steer{"hold on"}}, flight.session(), log);
  }
  commands_.step(flight.session(), log);
  publish();
  while (pace_.paused && pace_.steps == 0 && !pace_.reset && !stopped_()) {
    std::this_thread::sleep_for(kLook);
    commands_.take(flight.session(), log);
    publish();
  }
  if (pace_.steps > 0) --pace_.steps;
  if (time_ != nullptr && time_->factor() != pace_.speed) time_->set_factor(pace_.speed);
}

void FlightCommander::publish() {
  desk_.set_control({commands_.in_control(), true, pace_.paused, pace_.speed});
}

bool FlightCommander::ends(sim::Time /*next*/) const {
  return pace_.reset.has_value();
}

void FlightCommander::end() {
  commands_.end(kEnded);
  pace_.paused = false;
  pace_.steps = 0;
  publish();
}

std::optional<std::string> FlightCommander::next_mission() {
  while (!pace_.reset && !stopped_()) {
    for (const CommandDesk::Command& command : desk_.commands()) after_flight(command);
    publish();
    std::this_thread::sleep_for(kLook);
  }
  return pace_.reset;
}

void FlightCommander::after_flight(const CommandDesk::Command& command) {
  const auto answer = [&](bool good, const std::string& text) {
    desk_.answer({command.viewer, command.id, {{{}, {}, good, text}}});
  };
  const bool in_control = command.viewer == commands_.in_control();
  const auto* steer = std::get_if<CommandDesk::Steer>(&command.what);
  if (std::holds_alternative<CommandDesk::Gone>(command.what)) {
    if (in_control) commands_.give_control(0);
  } else if (std::holds_alternative<CommandDesk::TakeControl>(command.what)) {
    commands_.give_control(command.viewer);
    answer(true, "in control");
  } else if (steer == nullptr || !in_control) {
    answer(false, kEnded);
  } else {
    try {
      pace_.reset = parse_reset(steer->text, choice_);
      answer(pace_.reset.has_value(), pace_.reset ? steer->text : kEnded);
    } catch (const config::Error& error) {
      answer(false, error.what());
    }
  }
}

RepeatCommander::RepeatCommander(const flight::RecordedFlight& recorded)
    : recorded_{recorded}, commands_{desk_, changes_of(flight_, pace_)} {}

void RepeatCommander::step(flight::Flight& flight, sim::Time now, const Notify& note) {
  flight_ = &flight;
  const ViewerCommands::Log log = log_of(note, now);
  for (; next_ < recorded_.commands.size() && recorded_.commands[next_].at <= now; ++next_) {
    const auto line = parse_line(recorded_.commands[next_].text);
    if (!line) continue;
    if (is_refusal(line->text)) {
      log(line->viewer, line->text);
    } else if (const auto what = parse_command(line->text)) {
      commands_.start({line->viewer, {}, *what}, flight.session(), log);
    }
  }
  commands_.step(flight.session(), log);
}

bool RepeatCommander::ends(sim::Time next) const {
  return recorded_.ended && next >= *recorded_.ended;
}

}  // namespace rosflight::viewer
