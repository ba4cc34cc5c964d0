// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "log/byte_buffer.hpp"

namespace rosflight::log {

enum class Topic : std::uint8_t;  // flight_log_topics.hpp

/// Sees each message as it is logged: a view of the running flight.
class LogObserver {
 public:
  virtual ~LogObserver() = default;
  /// Called in the thread of the flight, which waits for it: copy and return.
  /// @param cdr  valid during the call.
  virtual void on_logged(Topic topic, std::uint64_t time_ns, Bytes cdr) = 0;
};

}  // namespace rosflight::log
