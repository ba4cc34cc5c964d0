// SPDX-License-Identifier: BSD-3-Clause
// What the session does with each kind of message.
#include <variant>

#include "companion/session.hpp"
#include "companion/version.hpp"

namespace rosflight::companion {

struct Session::Dispatcher {
  Session& s;

  template <class T>
  void stream(Latest<T>& latest, const T& m, const Stamp& stamp,
              void (Listener::*call)(const T&, const Stamp&)) {
    latest.set(m, stamp);
    announce(m, stamp);
    s.notify([&](Listener& l) { (l.*call)(m, stamp); });
  }

  template <class T>
  void announce(const T&, const Stamp& stamp) {
    s.notify([&](Listener& l) { l.on_received(s.codec_.message(), stamp); });
  }

  Stamp arrival() const { return {s.now_, s.now_, StampSource::kArrival}; }
  Stamp borrowed() const { return s.streams_.stamp_unstamped(s.now_, s.time_sync_); }

  // Streams.
  void operator()(const link::Imu& m) {
    if (const auto fcu = fcu_time(m.time_boot_us)) {
      s.fcu_clock(*fcu);
    }
    stream(s.streams_.imu, m, s.streams_.stamp(m, s.now_, s.time_sync_), &Listener::on_imu);
  }
  void operator()(const link::Attitude& m) {
    stream(s.streams_.attitude, m,
           s.streams_.stamp_with_imu_ms(m.time_boot_ms, s.now_, s.time_sync_),
           &Listener::on_attitude);
  }
  void operator()(const link::OutputRaw& m) {
    stream(s.streams_.output, m, s.streams_.stamp_with_imu_ms(m.time_boot_ms, s.now_, s.time_sync_),
           &Listener::on_output);
  }
  void operator()(const link::RcChannels& m) {
    const std::uint64_t us = std::uint64_t{m.time_boot_ms} * 1000;
    stream(s.streams_.rc, m, Streams::stamp_us(us, s.now_, s.time_sync_), &Listener::on_rc);
  }
  void operator()(const link::Gnss& m) {
    stream(s.streams_.gnss, m, Streams::stamp_us(m.time_boot_us, s.now_, s.time_sync_),
           &Listener::on_gnss);
  }
  void operator()(const link::Mag& m) { stream(s.streams_.mag, m, borrowed(), &Listener::on_mag); }
  void operator()(const link::Baro& m) {
    stream(s.streams_.baro, m, borrowed(), &Listener::on_baro);
  }
  void operator()(const link::DiffPressure& m) {
    stream(s.streams_.diff_pressure, m, borrowed(), &Listener::on_diff_pressure);
  }
  void operator()(const link::Range& m) {
    stream(s.streams_.range, m, borrowed(), &Listener::on_range);
  }
  void operator()(const link::BatteryStatus& m) {
    stream(s.streams_.battery, m, borrowed(), &Listener::on_battery);
  }
  void operator()(const link::Status& m) {
    s.commands_.set_armed(m.armed);
    stream(s.streams_.status, m, arrival(), &Listener::on_status);
  }
  void operator()(const link::Heartbeat& m) {
    stream(s.streams_.heartbeat, m, arrival(), &Listener::on_heartbeat);
  }

  // Answers and events.
  void operator()(const link::TimeSync& m) {
    announce(m, arrival());
    const Time old_offset = s.time_sync_.figures().offset;
    switch (s.time_sync_.answer(m, s.now_)) {
      case TimeSync::Answer::kIgnored:
        break;
      case TimeSync::Answer::kJumped:
        s.publish(ClockJumpEvent{old_offset, s.time_sync_.figures().offset});
        [[fallthrough]];
      case TimeSync::Answer::kAccepted:
        s.fcu_clock(Time{m.tc1_ns});
        break;
    }
  }
  void operator()(const link::ParamValue& m) {
    announce(m, arrival());
    s.parameters_.received(m);
    s.commands_.received(m);
    if (text_of(m.name) == "SYS_ID" && m.type == link::ParamType::kInt32) {
      s.options_.target_system = static_cast<std::uint8_t>(m.value.bits);
    }
  }
  void operator()(const link::CommandAck& m) {
    announce(m, arrival());
    s.publish(m);
    s.commands_.received(m);
  }
  void operator()(const link::StatusText& m) {
    announce(m, arrival());
    s.publish(LogEvent{m, s.now_});
    s.commands_.received(m);
  }
  void operator()(const link::HardError& m) {
    announce(m, arrival());
    s.publish(m);
  }
  void operator()(const link::CheckResult& m) {
    announce(m, arrival());
    s.publish(m);
  }
  void operator()(const link::Counters& m) {
    announce(m, arrival());
    s.publish(m);
  }
  void operator()(const link::RecordPart& m) { announce(m, arrival()); }
  void operator()(const link::Version& m) {
    announce(m, arrival());
    s.version_ = m;
    s.version_match_ = compare_versions(s.options_.version, text_of(m.text));
    s.version_request_.due = kNever;
    s.parameters_.set_firmware_version(text_of(m.text));
    s.publish(VersionEvent{m, s.version_match_});
  }

  // What only a companion sends.
  template <class T>
  void operator()(const T& m) {
    announce(m, arrival());
    ++s.statistics_.unexpected;
  }
};

void Session::dispatch(const link::Message& message) {
  if (connection_.received(now_, std::holds_alternative<link::Heartbeat>(message))) {
    ++statistics_.connections;
    publish(ConnectionEvent{ConnectionChange::kConnected, now_});
    parameters_.connected(statistics_.connections > 1);
    version_request_.due = version_.text[0] == '\0' ? now_ : version_request_.due;
    wake();
  }
  std::visit(Dispatcher{*this}, message);
}

}  // namespace rosflight::companion
