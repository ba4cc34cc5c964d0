// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "companion/events.hpp"
#include "companion/time.hpp"
#include "companion/transport.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// What the parts of a session may ask of it.
class Port {
 public:
  /// @returns false if the frame did not leave: link closed or its queue full. Try again later.
  virtual bool send(const link::Message& message, std::uint8_t qos) = 0;
  /// Companion time of the step in progress, or of the last one.
  virtual Time now() const = 0;
  /// The caller's due time may have moved nearer: run the timers in this step or the next.
  virtual void wake() = 0;
  virtual void publish(const Event& event) = 0;
  virtual std::uint8_t target_system() const = 0;

 protected:
  ~Port() = default;
};

}  // namespace rosflight::companion
