// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "companion/time.hpp"

namespace rosflight::companion {

/// Detects whether an FCU is connected and whether it has restarted.
///
/// Connected: a heartbeat was received, and since then no gap of `timeout` without a valid message.
/// Restarted: two consecutive stamps are more than 200 ms before the latest one. A single such stamp
/// may be a late datagram. Use only messages that are sent without delay (IMU, TIMESYNC answers).
class Connection {
 public:
  /// @param timeout  without a valid message, after which the connection is lost.
  explicit Connection(Time timeout = std::chrono::seconds{2}) : timeout_(timeout) {}

  /// A valid message was received. @returns true if it established the connection.
  bool received(Time now, bool is_heartbeat);
  /// @returns true if the connection was lost by now.
  bool expired(Time now);
  /// The earliest time at which expired() can return true.
  Time next_due() const { return connected_ ? last_received_ + timeout_ : kNever; }
  /// The link was closed. @returns true if there was a connection.
  bool close();

  /// Processes the FCU's clock from a message. @returns true if the FCU has restarted.
  bool fcu_clock(Time fcu);

  bool connected() const { return connected_; }
  Time last_received() const { return last_received_; }

 private:
  Time timeout_;
  bool connected_{false};
  Time last_received_{};
  std::optional<Time> latest_fcu_;
  bool went_back_{false};
};

}  // namespace rosflight::companion
