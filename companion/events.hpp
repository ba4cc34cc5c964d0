// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>
#include <variant>

#include "companion/time.hpp"
#include "link/messages.hpp"

/// Events of a link, besides the streams of samples. Plain values without heap.
namespace rosflight::companion {

enum class ConnectionChange : std::uint8_t {
  kLinkOpened,  ///< The transport can carry bytes.
  kLinkClosed,
  kConnected,  ///< An FCU sends heartbeats.
  kLost,       ///< No valid message of the FCU for the timeout.
  kRestarted   ///< The FCU's boot clock decreased: it restarted.
};

struct ConnectionEvent {
  ConnectionChange change{};
  Time time{};
};

/// A line of the FCU's log.
struct LogEvent {
  link::StatusText line;
  Time time{};
};

/// The FCU clock jumped relative to companion time; the new offset is in force from now on.
struct ClockJumpEvent {
  Time old_offset{};
  Time new_offset{};
};

/// A parameter was received for the first time, or with a new value.
struct ParameterEvent {
  link::ParamName name{};
  link::ParamType type{};
  link::ParamBits value{};
  bool first{};  ///< Received for the first time; there is no old value.
  link::ParamBits old_value{};
};

/// Progress of the parameter list: sent at its first value and when it is complete.
struct ParameterListEvent {
  std::size_t received{};
  std::size_t count{};
  bool complete{};
};

/// Values on the FCU differ from its stored ones, as far as this end has observed. What the firmware measures at every start does
/// not count.
struct UnsavedEvent {
  bool unsaved{};
};

enum class VersionMatch : std::uint8_t { kUnreadable, kSame, kDiffers };

struct VersionEvent {
  link::Version version;
  VersionMatch match{};  ///< Compares major and minor only.
};

/// The FCU was built with other message layouts: its frames are rejected, and only heartbeats are sent
/// to it. Published once, and again if its schema changes.
struct SchemaEvent {
  std::uint32_t ours{};
  std::uint32_t theirs{};
};
/// One line for a person.
std::string schema_text(const SchemaEvent& event);

using Event = std::variant<ConnectionEvent, LogEvent, ClockJumpEvent, ParameterEvent,
                           ParameterListEvent, UnsavedEvent, VersionEvent, SchemaEvent,
                           link::CommandAck, link::HardError, link::CheckResult, link::Counters>;

/// The text in a NUL-padded field that may lack the NUL.
template <std::size_t N>
std::string_view text_of(const std::array<char, N>& field) {
  std::size_t size = 0;
  while (size < N && field[size] != '\0') {
    ++size;
  }
  return {field.data(), size};
}

}  // namespace rosflight::companion
