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

std::uint32_t id(const Json& json) {
  const auto value = json.get<std::int64_t>();
  if (value < 0 || value > std::numeric_limits<std::uint32_t>::max())
    throw Json::other_error::create(501, "an id is no 32-bit number", &json);
  return static_cast<std::uint32_t>(value);
}

void read_request(const Json& json, Request& request) {
  const auto op = json.at("op").get<std::string>();
  if (op == "subscribe") {
    for (const Json& one : json.at("subscriptions")) {
      const std::uint32_t channel = id(one.at("channelId"));
      if (channel == 0) throw Json::other_error::create(501, "channel 0", &json);
      request.subscribe.emplace_back(id(one.at("id")), channel - 1);
    }
  } else if (op == "unsubscribe") {
    for (const Json& one : json.at("subscriptionIds")) request.unsubscribe.push_back(id(one));
  } else {
    request.complaint = "op: found " + op + ", known are subscribe, unsubscribe";
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

std::string server_info(std::string_view name, std::string_view session) {
  return text_of({{"op", "serverInfo"},
                  {"name", name},
                  {"capabilities", Json::array()},
                  {"supportedEncodings", Json::array()},
                  {"metadata", Json::object()},
                  {"sessionId", session}});
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
