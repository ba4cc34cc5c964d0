// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/foxglove.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>

namespace rosflight::web::server::foxglove {
namespace {

using Json = nlohmann::json;
constexpr std::array<std::string_view, 2> kProtocols{"foxglove.websocket.v1", "foxglove.sdk.v1"};

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// An unsigned integer of at most `max`. get<>() alone would cast whatever number or boolean stands there.
std::uint64_t whole(const Json& json, std::uint64_t max) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > max) {
    throw Json::other_error::create(
        501, "found " + text_of(json) + ", allowed an integer from 0 to " + std::to_string(max),
        &json);
  }
  return json.get<std::uint64_t>();
}

std::uint32_t id(const Json& json) {
  return static_cast<std::uint32_t>(whole(json, std::numeric_limits<std::uint32_t>::max()));
}

CommandDesk::TestMotor motor_test(const Json& json) {
  const auto motor =
      static_cast<std::uint8_t>(whole(json.at("motor"), std::numeric_limits<std::uint8_t>::max()));
  const Json& value = json.at("value");
  if (!value.is_number() || !(value.get<double>() >= 0.0 && value.get<double>() <= 1.0)) {
    throw Json::other_error::create(
        501, "value: found " + text_of(value) + ", allowed a number from 0 to 1", &json);
  }
  return {motor, value.get<double>()};
}

/// As on the link. A name with anything else is none, and must not get into a log.
std::string parameter_name(const Json& json) {
  constexpr std::size_t kMaxLength = 16;
  auto name = json.get<std::string>();
  const bool good = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
  if (!good || name.empty() || name.size() > kMaxLength)
    throw Json::other_error::create(501, "a parameter has no such name", &json);
  return name;
}

/// Printable, and short enough for a line of the log.
std::string change_text(const Json& json) {
  constexpr std::size_t kMaxLength = 200;
  auto text = json.get<std::string>();
  const bool good =
      std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (!good || text.empty() || text.size() > kMaxLength)
    throw Json::other_error::create(501, "a change has 1 to 200 printable characters", &json);
  return text;
}

CommandDesk::SetParameters set_parameters(const Json& json) {
  CommandDesk::SetParameters set;
  for (const Json& one : json.at("parameters")) {
    if (!one.at("value").is_number())
      throw Json::other_error::create(501, "the value of a parameter is no number", &json);
    set.values.emplace_back(parameter_name(one.at("name")), one.at("value").get<double>());
  }
  return set;
}

/// @returns whether it is one.
bool read_parameter_request(const std::string& op, const Json& json, Request& request) {
  if (op == "getParameters") {
    auto& names = request.get_parameters.emplace();
    for (const Json& name : json.at("parameterNames")) names.push_back(parameter_name(name));
  } else if (op == "setParameters") {
    request.command = set_parameters(json);
  } else if (op == "writeParameters") {
    request.command = CommandDesk::WriteParameters{};
  } else if (op == "reportChecks") {
    request.command = CommandDesk::ReportChecks{};
  } else if (op == "takeControl") {
    request.command = CommandDesk::TakeControl{};
  } else if (op == "calibrate") {
    request.command = CommandDesk::Calibrate{parameter_name(json.at("sensor"))};
  } else if (op == "testMotor") {
    request.command = motor_test(json);
  } else if (op == "steer") {
    request.command = CommandDesk::Steer{change_text(json.at("text"))};
  } else {
    return false;
  }
  request.id = json.value("id", "");
  return true;
}

/// A float is said to be one: JSON of 1.0 may be that of an integer.
Json parameter(const std::string& name, double value, bool is_float) {
  if (!is_float) return {{"name", name}, {"value", static_cast<std::int64_t>(value)}};
  return {{"name", name}, {"value", value}, {"type", "float64"}};
}

std::string values_text(Json parameters, std::string_view id, Json results) {
  Json json{{"op", "parameterValues"}, {"parameters", std::move(parameters)}};
  if (!id.empty()) json["id"] = id;
  if (!results.is_null()) json["results"] = std::move(results);
  return text_of(json);
}

void read_request(const Json& json, Request& request) {
  const auto op = json.at("op").get<std::string>();
  if (read_parameter_request(op, json, request)) return;
  if (op == "subscribe") {
    for (const Json& one : json.at("subscriptions")) {
      const std::uint32_t channel = id(one.at("channelId"));
      if (channel == 0) throw Json::other_error::create(501, "channel 0", &json);
      request.subscribe.emplace_back(id(one.at("id")), channel - 1);
    }
  } else if (op == "unsubscribe") {
    for (const Json& one : json.at("subscriptionIds")) request.unsubscribe.push_back(id(one));
  } else {
    request.complaint = "op: found " + op +
                        ", known are subscribe, unsubscribe, getParameters, setParameters, "
                        "writeParameters, reportChecks, takeControl, steer, testMotor, calibrate";
  }
}

}  // namespace

std::optional<std::string_view> chosen_protocol(std::string_view offered) {
  while (!offered.empty()) {
    const std::size_t comma = offered.find(',');
    std::string_view name = offered.substr(0, comma);
    offered = comma == std::string_view::npos ? std::string_view() : offered.substr(comma + 1);
    while (name.starts_with(' ')) name.remove_prefix(1);
    while (name.ends_with(' ')) name.remove_suffix(1);
    const auto* const known = std::find(kProtocols.begin(), kProtocols.end(), name);
    if (known != kProtocols.end()) return *known;
  }
  return std::nullopt;
}

std::string server_info(std::string_view name, std::string_view session, bool parameters,
                        bool commands) {
  Json capabilities = Json::array();
  if (parameters) capabilities.push_back("parameters");
  return text_of({{"op", "serverInfo"},
                  {"name", name},
                  {"capabilities", std::move(capabilities)},
                  {"supportedEncodings", Json::array()},
                  {"metadata", {{"commands", commands ? "yes" : "no"}}},
                  {"sessionId", session}});
}

std::string parameter_values(const CommandDesk::Parameters& parameters,
                             std::span<const std::string> names, std::string_view id) {
  Json wanted = Json::array();
  for (const CommandDesk::Parameter& one : parameters.all) {
    if (names.empty() || std::find(names.begin(), names.end(), one.name) != names.end())
      wanted.push_back(parameter(one.name, one.value, one.is_float));
  }
  return values_text(std::move(wanted), id, nullptr);
}

std::string command_results(const CommandDesk::Answer& answer) {
  Json values = Json::array();
  Json results = Json::array();
  for (const CommandDesk::Result& one : answer.results) {
    if (one.value) values.push_back(parameter(one.name, *one.value, true));
    results.push_back({{"name", one.name}, {"good", one.good}, {"text", one.text}});
  }
  return values_text(std::move(values), answer.id, std::move(results));
}

std::string parameters_unsaved(bool unsaved) {
  return text_of({{"op", "parameterValues"}, {"parameters", Json::array()}, {"unsaved", unsaved}});
}

std::string control_text(const CommandDesk::Control& control, std::uint64_t viewer) {
  return text_of({{"op", "parameterValues"},
                  {"parameters", Json::array()},
                  {"control",
                   {{"you", viewer},
                    {"viewer", control.viewer},
                    {"simulated", control.simulated},
                    {"paused", control.paused},
                    {"speed", control.speed}}}});
}

std::string advertise(std::size_t first, std::span<const LiveData::Channel> channels) {
  Json all = Json::array();
  for (std::size_t k = 0; k < channels.size(); ++k) {
    all.push_back({{"id", first + k + 1},
                   {"topic", channels[k].topic},
                   {"encoding", "cdr"},
                   {"schemaName", channels[k].type},
                   {"schemaEncoding", "ros2msg"},
                   {"schema", channels[k].schema}});
  }
  return text_of({{"op", "advertise"}, {"channels", std::move(all)}});
}

std::string status_error(std::string_view text) {
  constexpr int kError = 2;
  return text_of({{"op", "status"}, {"level", kError}, {"message", text}});
}

std::string message_head(std::uint32_t subscription, std::uint64_t time_ns) {
  std::string head{'\x01'};  // message data
  for (unsigned shift = 0; shift < 32; shift += 8)
    head += static_cast<char>((subscription >> shift) & 255U);
  for (unsigned shift = 0; shift < 64; shift += 8)
    head += static_cast<char>((time_ns >> shift) & 255U);
  return head;
}

std::string parse_token(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    return json.at("op") == "token" ? json.at("token").get<std::string>() : "";
  } catch (const Json::exception&) {
    return "";
  }
}

Request parse_request(std::string_view text) {
  Request request;
  try {
    read_request(Json::parse(text), request);
  } catch (const Json::exception& error) {
    request = {};
    request.complaint = error.what();
  }
  return request;
}

}  // namespace rosflight::web::server::foxglove
