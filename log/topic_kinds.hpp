// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>

#include "log/flight_log_topics.hpp"

namespace rosflight::log {

/// What a view of a flight needs of a topic.
enum class TopicKind : std::uint8_t {
  kState,     ///< The latest message is enough, at the rate of a plot.
  kExchange,  ///< Requests and answers at once: who looks seldom has both.
  kEvent,     ///< Rare, and each message matters long after it came.
  kBulk       ///< Bytes for other programs; no plot shows them.
};

constexpr TopicKind kind_of(Topic topic) {
  constexpr std::array kEvents{Topic::kStatus,
                               Topic::kVersion,
                               Topic::kHardError,
                               Topic::kParamRequestRead,
                               Topic::kParamSet,
                               Topic::kParamValue,
                               Topic::kParamRequestList,
                               Topic::kCommandRequest,
                               Topic::kCommandAck,
                               Topic::kMotorTest,
                               Topic::kReportRequest,
                               Topic::kCheckResult,
                               Topic::kPhase,
                               Topic::kParameter,
                               Topic::kTexts,
                               Topic::kTfStatic,
                               Topic::kPath,
                               Topic::kRobotDescription,
                               Topic::kSettings};
  if (std::find(kEvents.begin(), kEvents.end(), topic) != kEvents.end()) return TopicKind::kEvent;
  if (topic == Topic::kTimeSync) return TopicKind::kExchange;
  return topic == Topic::kRawFrames || topic == Topic::kBoardInputs ? TopicKind::kBulk
                                                                    : TopicKind::kState;
}

}  // namespace rosflight::log
