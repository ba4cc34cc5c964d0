// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "companion/events.hpp"
#include "companion/time.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// Receives the messages and events of a session; override the functions you need. Calls come from
/// inside Session::step (on_sent also from the sending call), in the order of the bytes. A listener
/// may start jobs and send, but must not step the session.
class Listener {
 public:
  virtual ~Listener() = default;

  /// A message with the times of its arrival and of its sample.
  virtual void on_imu(const link::Imu&, const Stamp&) {}
  /// The firmware's attitude estimate.
  virtual void on_attitude(const link::Attitude&, const Stamp&) {}
  /// Magnetometer.
  virtual void on_mag(const link::Mag&, const Stamp&) {}
  /// Barometer.
  virtual void on_baro(const link::Baro&, const Stamp&) {}
  /// Differential pressure of the pitot tube.
  virtual void on_diff_pressure(const link::DiffPressure&, const Stamp&) {}
  /// Distance to the ground.
  virtual void on_range(const link::Range&, const Stamp&) {}
  /// Receiver channels.
  virtual void on_rc(const link::RcChannels&, const Stamp&) {}
  /// Outputs of the mixer.
  virtual void on_output(const link::OutputRaw&, const Stamp&) {}
  /// Position and velocity by satellites.
  virtual void on_gnss(const link::Gnss&, const Stamp&) {}
  /// Voltage and current.
  virtual void on_battery(const link::BatteryStatus&, const Stamp&) {}
  /// State, errors and override of the firmware.
  virtual void on_status(const link::Status&, const Stamp&) {}
  /// Kind of vehicle.
  virtual void on_heartbeat(const link::Heartbeat&, const Stamp&) {}

  /// See events.hpp.
  virtual void on_event(const Event&) {}

  /// Every received message, for recorders; before the function of its kind.
  virtual void on_received(const link::Message&, const Stamp&) {}
  /// Every sent message with the time of sending.
  virtual void on_sent(const link::Message&, Time) {}
};

}  // namespace rosflight::companion
