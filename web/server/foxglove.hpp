// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "web/server/command_desk.hpp"
#include "web/server/live_data.hpp"

/// The Foxglove WebSocket protocol v1, server's side, as far as it is used: channels, subscriptions,
/// messages, parameters. Text frames are JSON objects with a member `op`, binary frames little-endian.
/// Additions of this project are the client's operations token, writeParameters, reportChecks, takeControl, steer,
/// testMotor and calibrate, and the members `results`, `unsaved` and `control` of parameterValues: clients ignore
/// members, but not operations.
namespace rosflight::web::server::foxglove {

/// The name of the protocol to answer with, out of those that a client offers (the header
/// Sec-WebSocket-Protocol); nothing if it offers none that is known.
std::optional<std::string_view> chosen_protocol(std::string_view offered);

/// @param session  the same for all clients of one start of the server.
/// @param parameters  whether they can be asked for; @param commands  whether they can be set.
std::string server_info(std::string_view name, std::string_view session, bool parameters,
                        bool commands);
/// Those with these names, or all. @param id  of the client's request; may be empty.
std::string parameter_values(const CommandDesk::Parameters& parameters,
                             std::span<const std::string> names, std::string_view id);
/// The values in force after a command, and how each part of it ended.
std::string command_results(const CommandDesk::Answer& answer);
std::string parameters_unsaved(bool unsaved);
/// @param viewer  the number of the viewer that receives it.
std::string control_text(const CommandDesk::Control& control, std::uint64_t viewer);
/// @param first  number of the first channel; others follow. Clients see numbers one larger.
std::string advertise(std::size_t first, std::span<const LiveData::Channel> channels);
/// A complaint about what the client sent.
std::string status_error(std::string_view text);
/// The 13 bytes before a message's contents.
std::string message_head(std::uint32_t subscription, std::uint64_t time_ns);

/// The token in {"op":"token","token":"..."}, which is no part of Foxglove's protocol; else nothing.
std::string parse_token(std::string_view text);

/// What a client wants; channels by their number.
struct Request {
  std::vector<std::pair<std::uint32_t, std::size_t>> subscribe;  ///< Its own id, channel.
  std::vector<std::uint32_t> unsubscribe;                        ///< Its own ids.
  std::optional<std::vector<std::string>> get_parameters;        ///< Names; empty: all.
  std::optional<CommandDesk::What> command;
  std::string id;         ///< Request id of the two above, for the answer.
  std::string complaint;  ///< Not empty: what is wrong, for status_error().
};
/// Anything may come; what is not understood becomes a complaint.
Request parse_request(std::string_view text);

}  // namespace rosflight::web::server::foxglove
