// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/command.hpp"
#include "firmware/core/controller.hpp"
#include "firmware/core/crash_record.hpp"
#include "firmware/core/estimator.hpp"
#include "firmware/core/log.hpp"
#include "firmware/core/parameters.hpp"
#include "firmware/core/sensors.hpp"
#include "firmware/core/state_machine.hpp"
#include "link/codec.hpp"

namespace rosflight::core {

/// The sending half of the link: what goes out in a pass, and in which order. Sensor messages
/// follow their samples; lists and texts fill the room that is left.
class Telemetry {
 public:
  static constexpr Time kPeerSilence = hal::milliseconds(3000);

  Telemetry(hal::Serial& serial, link::Codec& codec) : serial_{serial}, codec_{codec} {}

  void send(const link::Message& message, std::uint8_t qos = hal::Serial::kOrdinary);
  void send_parameter(Param id, const Parameters& parameters);
  void send_ack(std::uint8_t command, bool success);

  /// What follows the sensors, in this order: IMU, attitude, outputs (with every 8th IMU sample,
  /// the first one included), differential pressure, barometer, magnetometer, range, battery, GNSS.
  void stream(Time now, const Measurements& m, const AttitudeEstimate& attitude,
              const hal::OutputValues& outputs);
  void send_rc(Time now, const hal::RcFrame& frame);
  /// Once per pass: heartbeat, and whether it is time for a status message. @returns true if so.
  bool tick(Time now, bool fixed_wing);
  /// Once per pass, last: changed parameters, the parameter list, texts.
  void send_backlog(Parameters& parameters, Log& log);

  /// The next tick() says true, whatever the clock says.
  void request_status() { status_due_ = true; }
  void start_list() { next_listed_ = 0; }
  void heard_peer(Time now);
  bool connected() const { return connected_; }
  /// Held until a peer is there.
  void report_crash(const CrashRecord& record, bool rearmed);

 private:
  void stream_outputs(Time now, const hal::OutputValues& outputs);

  hal::Serial& serial_;
  link::Codec& codec_;
  link::HardError crash_{};
  Time last_heard_{};
  Time next_tenth_{};
  std::uint16_t next_listed_{static_cast<std::uint16_t>(kParamCount)};
  std::uint8_t imu_count_{0};
  bool status_due_{false};
  bool connected_{false};
  bool crash_waiting_{false};
};

}  // namespace rosflight::core
