// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>
#include <variant>

#include "companion/time.hpp"
#include "link/messages.hpp"

/// What happens on a link besides the flow of samples. Plain values without heap.
namespace rosflight::companion {

enum class ConnectionChange : std::uint8_t {
  kLinkOpened,  ///< The transport can carry bytes.
  kLinkClosed,
  kConnected,  ///< An FCU sends heartbeats.
  kLost,       ///< Nothing valid from the FCU for the time-out.
  kRestarted   ///< The FCU's boot clock went back: it started anew.
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

/// The FCU clock jumped against ours; the new offset is in force from here on.
struct ClockJumpEvent {
  Time old_offset{};
  Time new_offset{};
};

/// A parameter was seen for the first time, or has another value than before.
struct ParameterEvent {
  link::ParamName name{};
  link::ParamType type{};
  link::ParamBits value{};
  bool first{};  ///< First sight; there is no old value.
  link::ParamBits old_value{};
};

/// Progress of the parameter list: sent at its first value and when it is complete.
struct ParameterListEvent {
  std::size_t received{};
  std::size_t count{};
  bool complete{};
};

/// Values on the FCU differ from those it has stored (as far as this end can know).
struct UnsavedEvent {
  bool unsaved{};
};

enum class VersionMatch : std::uint8_t { kUnreadable, kSame, kDiffers };

struct VersionEvent {
  link::Version version;
  VersionMatch match{};  ///< Compares major and minor only.
};

/// The FCU was built from other messages than we are: nothing of it is understood, and nothing but
/// heartbeats is sent to it. Told once, and again if its schema changes.
struct SchemaEvent {
  std::uint32_t ours{};
  std::uint32_t theirs{};
};
/// What to tell people: one line.
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
