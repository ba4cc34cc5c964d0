// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "config/strict_yaml.hpp"

namespace rosflight::viewer {
namespace {

using Desk = web::server::CommandDesk;
using companion::ParameterResult;

constexpr std::string_view kSets = "sets";
constexpr std::string_view kWrites = "writes the parameters";
constexpr std::string_view kAsks = "asks for the checks before arming";
constexpr std::string_view kTakes = "takes control";
constexpr std::string_view kSteers = "steers: ";
constexpr std::string_view kTests = "tests motor ";
constexpr std::string_view kCalibrates = "calibrates ";
constexpr std::string_view kCalibration = "calibration: ";
constexpr std::string_view kStop = "stop";
constexpr std::string_view kLeaves = "is gone";
constexpr std::string_view kRefused = "is refused: ";

Desk::Result result_of(const ParameterResult& entry) {
  const std::optional<double> value =
      entry.value ? std::optional(entry.value->number()) : std::nullopt;
  return {entry.name, value, entry.ok(), entry.text};
}

/// "NAME VALUE NAME VALUE ...".
std::optional<Desk::SetParameters> parse_values(std::string_view text) {
  Desk::SetParameters set;
  std::istringstream words{std::string(text)};
  for (std::string name, number; words >> name;) {
    words >> number;
    const auto value = config::parse_number(number);
    if (!words || !value) return std::nullopt;
    set.values.emplace_back(name, *value);
  }
  return set;
}

}  // namespace

std::string text_of(const ViewerCommands::What& what) {
  if (const auto* set = std::get_if<Desk::SetParameters>(&what)) {
    std::string text{kSets};
    for (const auto& [name, value] : set->values) text += fmt::format(" {} {}", name, value);
    return text;
  }
  if (const auto* steer = std::get_if<Desk::Steer>(&what)) return kSteers.data() + steer->text;
  if (const auto* test = std::get_if<Desk::TestMotor>(&what))
    return fmt::format("{}{} {}", kTests, test->motor, test->value);
  if (const auto* calibrate = std::get_if<Desk::Calibrate>(&what))
    return kCalibrates.data() + calibrate->sensor;
  if (std::holds_alternative<Desk::WriteParameters>(what)) return std::string(kWrites);
  if (std::holds_alternative<Desk::ReportChecks>(what)) return std::string(kAsks);
  return std::string(std::holds_alternative<Desk::Gone>(what) ? kLeaves : kTakes);
}

std::optional<ViewerCommands::What> parse_command(std::string_view text) {
  if (text.starts_with(kSets)) {
    const auto set = parse_values(text.substr(kSets.size()));
    return set ? std::optional<ViewerCommands::What>(*set) : std::nullopt;
  }
  if (text.starts_with(kSteers)) return Desk::Steer{std::string(text.substr(kSteers.size()))};
  if (text.starts_with(kTests)) {
    const auto set = parse_values(text.substr(kTests.size()));
    if (!set || set->values.size() != 1) return std::nullopt;
    const auto motor = config::parse_number(set->values[0].first);
    if (!motor || *motor < 0.0 || *motor > 255.0 || *motor != std::floor(*motor))
      return std::nullopt;
    return Desk::TestMotor{static_cast<std::uint8_t>(*motor), set->values[0].second};
  }
  if (text.starts_with(kCalibrates))
    return Desk::Calibrate{std::string(text.substr(kCalibrates.size()))};
  if (text == kWrites) return Desk::WriteParameters{};
  if (text == kAsks) return Desk::ReportChecks{};
  if (text == kLeaves) return Desk::Gone{};
  if (text.starts_with(kTakes)) return Desk::TakeControl{};
  return std::nullopt;
}

bool is_refusal(std::string_view text) {
  return text.starts_with(kRefused);
}

ViewerCommands::ViewerCommands(web::server::CommandDesk& desk, ParseChange parse_change)
    : desk_{desk}, parse_change_{std::move(parse_change)} {}

void ViewerCommands::take(companion::Session& session, const Log& log) {
  for (const Desk::Command& command : desk_.commands()) start(command, session, log);
}

bool ViewerCommands::Waiting::pending() {
  if (calibration) return !calibration->step();
  return plain ? plain->pending() : load.pending();
}

void ViewerCommands::step(companion::Session& session, const Log& log) {
  take(session, log);
  std::erase_if(waiting_, [this](Waiting& one) {
    if (one.pending()) return false;
    if (one.calibration) {
      one.answer.results.push_back({{}, {}, one.calibration->good(), one.calibration->text()});
    } else if (one.plain) {
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

std::string ViewerCommands::refusal(const Desk::Command& command) const {
  if (std::holds_alternative<Desk::Steer>(command.what) && !parse_change_)
    return "a real vehicle cannot be steered from here";
  const bool looks = std::holds_alternative<Desk::ReportChecks>(command.what);
  if (!looks && command.viewer != in_control_) {
    return in_control_ == 0 ? "take control first"
                            : fmt::format("viewer {} has control", in_control_);
  }
  const auto* calibrate = std::get_if<Desk::Calibrate>(&command.what);
  return calibrate ? refusal_of_calibration(calibrate->sensor) : std::string();
}

std::string ViewerCommands::refusal_of_calibration(const std::string& name) const {
  if (name == kStop) return procedure_ ? "" : "no calibration runs";
  if (procedure_) return procedure_->name + " is being calibrated";
  if (ground::find_sensor(name) != nullptr ||
      std::find(procedures_.begin(), procedures_.end(), name) != procedures_.end())
    return {};
  std::string allowed = "allowed: gyro, accel, baro, airspeed";
  for (const std::string& one : procedures_) allowed += ", " + one;
  return allowed;
}

void ViewerCommands::refuse(const Desk::Command& command, std::string why, const Log& log) {
  log(command.viewer, fmt::format("{}{}: {}", kRefused, text_of(command.what), why));
  answer(command, false, std::move(why));
}

void ViewerCommands::answer(const Desk::Command& command, bool good, std::string text) {
  desk_.answer({command.viewer, command.id, {{{}, {}, good, std::move(text)}}});
}

void ViewerCommands::start(const Desk::Command& command, companion::Session& session,
                           const Log& log) {
  if (std::holds_alternative<Desk::Gone>(command.what)) {
    if (command.viewer != in_control_) return;
    log(command.viewer, text_of(command.what));
    in_control_ = 0;
    return;
  }
  if (std::holds_alternative<Desk::TakeControl>(command.what)) {
    const bool from = in_control_ != 0 && in_control_ != command.viewer;
    log(command.viewer,
        text_of(command.what) + (from ? fmt::format(" from viewer {}", in_control_) : ""));
    in_control_ = command.viewer;
    return answer(command, true, "in control");
  }
  if (std::string why = refusal(command); !why.empty()) return refuse(command, std::move(why), log);
  if (const auto* steer = std::get_if<Desk::Steer>(&command.what)) {
    try {
      const std::function<void()> change = parse_change_(steer->text);
      log(command.viewer, text_of(command.what));
      change();
      return answer(command, true, steer->text);
    } catch (const config::Error& error) {
      return refuse(command, error.what(), log);
    }
  }
  log(command.viewer, text_of(command.what));
  if (const auto* test = std::get_if<Desk::TestMotor>(&command.what)) {
    const bool sent = session.test_motor(test->motor, static_cast<float>(test->value));
    return answer(command, sent, sent ? "sent" : "the link is down");
  }
  start_on_vehicle(command, session);
}

void ViewerCommands::start_on_vehicle(const Desk::Command& command, companion::Session& session) {
  Waiting waiting{{command.viewer, command.id, {}}, {}, {}, {}};
  if (const auto* set = std::get_if<Desk::SetParameters>(&command.what)) {
    start_load(*set, session, waiting);
  } else if (const auto* calibrate = std::get_if<Desk::Calibrate>(&command.what)) {
    if (!start_calibration(command, calibrate->sensor, session, waiting)) return;
  } else if (std::holds_alternative<Desk::WriteParameters>(command.what)) {
    waiting.plain = session.commands().start(link::Command::kWriteParams);
  } else {
    const bool sent = session.request_report(link::ReportKind::kChecks);
    waiting.answer.results.push_back({{}, {}, sent, sent ? "asked" : "the link is down"});
  }
  waiting_.push_back(std::move(waiting));
}

bool ViewerCommands::start_calibration(const Desk::Command& command, const std::string& name,
                                       companion::Session& session, Waiting& waiting) {
  if (name == kStop) {
    procedure_->stopped = true;
    answer(command, true, "stopping");
    return false;
  }
  if (const ground::Sensor* sensor = ground::find_sensor(name)) {
    waiting.calibration = std::make_unique<ground::SensorCalibration>(session, *sensor);
    return true;
  }
  procedure_ = Procedure{std::move(waiting.answer), name};
  return false;
}

std::optional<std::string> ViewerCommands::begin_procedure() {
  if (!procedure_ || std::exchange(procedure_->begun, true)) return std::nullopt;
  return procedure_->name;
}

bool ViewerCommands::procedure_stopped() const {
  return procedure_ && procedure_->begun &&
         (procedure_->stopped || procedure_->answer.viewer != in_control_);
}

void ViewerCommands::log_line(const std::string& line, const Log& log) const {
  if (procedure_) log(procedure_->answer.viewer, kCalibration.data() + line);
}

void ViewerCommands::end_procedure(bool good, std::string text) {
  if (!procedure_) return;
  procedure_->answer.results.push_back({{}, {}, good, std::move(text)});
  desk_.answer(std::move(procedure_->answer));
  procedure_.reset();
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

void ViewerCommands::end(const std::string& why) {
  for (Waiting& one : waiting_) {
    one.answer.results.push_back({{}, {}, false, why});
    desk_.answer(std::move(one.answer));
  }
  waiting_.clear();
  end_procedure(false, why);
}

}  // namespace rosflight::viewer
