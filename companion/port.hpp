// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "companion/events.hpp"
#include "companion/time.hpp"
#include "companion/transport.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// The services of a session for its parts.
class Port {
 public:
  /// Sends a message. @returns false if it was not sent: link closed or its queue full.
  virtual bool send(const link::Message& message, std::uint8_t qos) = 0;
  /// Companion time of the step in progress, or of the last one.
  virtual Time now() const = 0;
  /// The caller's due time may be earlier now: the timers run in this step or the next.
  virtual void wake() = 0;
  /// Passes an event to all listeners.
  virtual void publish(const Event& event) = 0;
  virtual std::uint8_t target_system() const = 0;

 protected:
  ~Port() = default;
};

}  // namespace rosflight::companion
