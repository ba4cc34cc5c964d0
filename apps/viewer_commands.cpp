// SPDX-License-Identifier: BSD-3-Clause
#include "apps/viewer_commands.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace rosflight::apps {
namespace {

using Desk = web::server::CommandDesk;
using companion::ParameterResult;

constexpr const char* kEnded = "the flight has ended";

/// What a command is in the log.
std::string text_of(const Desk::Command& command) {
  if (const auto* set = std::get_if<Desk::SetParameters>(&command.what)) {
    std::string text = "sets";
    for (const auto& [name, value] : set->values) text += fmt::format(" {} {:.9g}", name, value);
    return text;
  }
  return std::holds_alternative<Desk::WriteParameters>(command.what)
             ? "writes the parameters"
             : "asks for the checks before arming";
}

Desk::Result result_of(const ParameterResult& entry) {
  const std::optional<double> value =
      entry.value ? std::optional(entry.value->number()) : std::nullopt;
  return {entry.name, value, entry.ok(), entry.text};
}

}  // namespace

void ViewerCommands::step(companion::Session& session, sim::Time now,
                          const flight::MissionRunner::Notify& note) {
  for (const Desk::Command& command : desk_.commands()) start(command, session, now, note);
  std::erase_if(waiting_, [this](Waiting& one) {
    if (one.plain ? one.plain->pending() : one.load.pending()) return false;
    if (one.plain) {
      one.answer.results.push_back({{}, {}, one.plain->done(), one.plain->text()});
    } else {
      for (const ParameterResult& entry : one.load.result().entries)
        one.answer.results.push_back(result_of(entry));
    }
    desk_.answer(std::move(one.answer));
    return true;
  });
  publish_parameters(session.parameters());
}

void ViewerCommands::start(const Desk::Command& command, companion::Session& session, sim::Time now,
                           const flight::MissionRunner::Notify& note) {
  note({now, "viewer", link::Severity::kInfo,
        fmt::format("viewer {} {}", command.viewer, text_of(command))});
  Waiting waiting{{command.viewer, command.id, {}}, {}, {}};
  if (const auto* set = std::get_if<Desk::SetParameters>(&command.what)) {
    start_load(*set, session, waiting);
  } else if (std::holds_alternative<Desk::WriteParameters>(command.what)) {
    waiting.plain = session.commands().start(link::Command::kWriteParams);
  } else {
    const bool sent = session.request_report(link::ReportKind::kChecks);
    waiting.answer.results.push_back({{}, {}, sent, sent ? "asked" : "the link is down"});
  }
  waiting_.push_back(std::move(waiting));
}

/// A value that the vehicle cannot have is not sent.
void ViewerCommands::start_load(const Desk::SetParameters& set, companion::Session& session,
                                Waiting& waiting) {
  const companion::ParameterTable& table = session.parameters().table();
  companion::ParameterSet values;
  for (const auto& [name, number] : set.values) {
    const auto index = table.find(name);
    std::string error = "the vehicle has no such parameter";
    const auto value =
        index ? companion::to_value(number, table[*index].value.type, error) : std::nullopt;
    if (value) {
      values.push_back({name, *value});
    } else {
      waiting.answer.results.push_back({name, {}, false, name + ": " + error});
    }
  }
  companion::put_mixers_last(values);
  if (!values.empty()) waiting.load = session.parameters().load(std::move(values));
}

void ViewerCommands::publish_parameters(const companion::ParameterClient& client) {
  const std::pair<std::uint64_t, bool> now{client.revision(), client.unsaved()};
  if (!client.complete() || published_ == now) return;
  published_ = now;
  Desk::Parameters parameters{{}, client.unsaved()};
  for (const companion::NamedValue& one : client.table().values()) {
    parameters.all.push_back(
        {one.name, one.value.number(), one.value.type == link::ParamType::kFloat});
  }
  desk_.set_parameters(std::move(parameters));
}

void ViewerCommands::end() {
  for (Waiting& one : waiting_) {
    one.answer.results.push_back({{}, {}, false, kEnded});
    desk_.answer(std::move(one.answer));
  }
  waiting_.clear();
  desk_.close(kEnded);
}

}  // namespace rosflight::apps
