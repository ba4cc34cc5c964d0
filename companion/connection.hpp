// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "companion/time.hpp"

namespace rosflight::companion {

/// Knows whether an FCU is at the other end and whether it has started anew.
///
/// Connected: a heartbeat came, and since then never more than `timeout` without a valid message.
/// Restarted: two stamps running lie more than 200 ms before the latest one seen. One such stamp
/// may be a late datagram; a clock does not go back twice. Feed it only prompt messages (IMU,
/// TIMESYNC answers).
class Connection {
 public:
  explicit Connection(Time timeout = std::chrono::seconds{2}) : timeout_(timeout) {}

  /// Any valid message. @returns true if this made the connection.
  bool received(Time now, bool is_heartbeat);
  /// @returns true if the connection was lost by now.
  bool expired(Time now);
  /// When expired() can turn true at the earliest.
  Time next_due() const { return connected_ ? last_received_ + timeout_ : kNever; }
  /// The link itself closed. @returns true if there was a connection.
  bool close();

  /// Takes the FCU's clock as seen in a message. @returns true if the FCU has restarted.
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
