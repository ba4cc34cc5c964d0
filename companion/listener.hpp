// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "companion/events.hpp"
#include "companion/time.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// What a session tells. Override what you need. Calls come from inside Session::step (on_sent also
/// from the sending call), in the order of the bytes; a listener may start jobs and send, but not
/// step the session.
class Listener {
 public:
  virtual ~Listener() = default;

  virtual void on_imu(const link::Imu&, const Stamp&) {}
  virtual void on_attitude(const link::Attitude&, const Stamp&) {}
  virtual void on_mag(const link::Mag&, const Stamp&) {}
  virtual void on_baro(const link::Baro&, const Stamp&) {}
  virtual void on_diff_pressure(const link::DiffPressure&, const Stamp&) {}
  virtual void on_range(const link::Range&, const Stamp&) {}
  virtual void on_rc(const link::RcChannels&, const Stamp&) {}
  virtual void on_output(const link::OutputRaw&, const Stamp&) {}
  virtual void on_gnss(const link::Gnss&, const Stamp&) {}
  virtual void on_battery(const link::BatteryStatus&, const Stamp&) {}
  virtual void on_status(const link::Status&, const Stamp&) {}
  virtual void on_heartbeat(const link::Heartbeat&, const Stamp&) {}

  virtual void on_event(const Event&) {}

  /// Every message of the link, for recorders; before the call that is special to its kind.
  virtual void on_received(const link::Message&, const Stamp&) {}
  virtual void on_sent(const link::Message&, Time) {}
};

}  // namespace rosflight::companion
