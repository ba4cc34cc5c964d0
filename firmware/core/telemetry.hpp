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

/// The transmitting half of the link: which messages a pass sends, and in which order. Sensor
/// messages follow their samples; lists and texts use the remaining capacity.
///
/// A line that cannot carry every sample gets every n-th of each kind. It carries C = baud/10 bytes
/// per second; R = max(C/4, 600) of them are kept for heartbeat, status, acknowledgements, time
/// synchronisation, parameters and texts, and with O bytes per second of samples offered
///
///     n = ceil(O / (C - R))                                                                 (1)
///
/// measured once a second (48 kB/s are assumed for the first); n falls only when there is a tenth
/// to spare. n = 1 whenever all fits: from 921 600 baud on with an IMU at 400 Hz. If all but IMU,
/// attitude and outputs, S bytes per second, needs at most a quarter of C - R, then only these three
/// are thinned out, and a fast gyro costs no GNSS solution:
///
///     n = ceil((O - S) / (C - R - S)), 1 for the others                                     (2)
///
/// n = 1 as well while the port carries all.
///
/// While n > 1 a sample also waits for its next turn unless the transmit queue keeps 128 bytes for the
/// others.
/// Below 20 000 baud the status leaves twice a second and on change, else ten times.
class Telemetry {
 public:
  static constexpr Time kPeerSilence = hal::milliseconds(3000);
  /// Outputs, receiver channels, two parameters, a text.
  static constexpr std::uint8_t kMessagesWithoutImu = 5;
  /// A due message is postponed for at most this many passes with sensor samples.
  static constexpr std::uint8_t kMaxPassedOver = 8;

  /// @param serial  the port; must outlive this. @param codec  likewise.
  Telemetry(hal::Serial& serial, link::Codec& codec) : serial_{serial}, codec_{codec} {}

  /// Capacity of the line, if the serial port accepted the rate; without it nothing is decimated.
  void set_line(std::uint32_t bytes_per_s);

  /// Sends a message; a frame that the serial port rejects is counted.
  void send(const link::Message& message);
  /// Sends the value of a parameter with its index and the count.
  void send_parameter(Param id, const Parameters& parameters);
  /// Sends the acknowledgement of a command.
  void send_ack(std::uint8_t command, bool success);

  /// Sends the messages of new samples, in this order: IMU, attitude, differential pressure, barometer,
  /// magnetometer, range, battery, GNSS. With every 8th IMU sample, the first one included, the
  /// outputs are due.
  void stream(const Measurements& m, const AttitudeEstimate& attitude);
  /// A frame of the receiver is due.
  void note_rc() { rc_due_ = turn(kRc); }
  /// Once per pass: heartbeat, and whether it is time for a status message. @returns true if so.
  bool tick(Time now, bool fixed_wing) {
    if (now >= next_tenth_) tenth(now, fixed_wing);
    const bool due = status_due_;
    status_due_ = false;
    return due;
  }
  /// Contents of messages that can wait for a later pass.
  struct Waiting {
    const hal::OutputValues& outputs;
    const hal::RcFrame& rc;
  };
  /// Once per pass, last: outputs, receiver channels, parameters, texts. A pass with an IMU sample
  /// sends one of these, or one aiding sensor's message instead; a pass without all that is due.
  void send_backlog(Time now, const Waiting& w, Parameters& parameters, Log& log) {
    if (outputs_due_ || rc_due_ || next_listed_ < kParamCount || parameters.has_unreported() ||
        (connected_ && !log.empty())) {
      send_waiting(now, w, parameters, log);
    }
  }

  /// The next tick() returns true, independent of the clock.
  void request_status() { status_due_ = true; }
  /// Starts to send every parameter.
  void start_list() {
    next_listed_ = 0;
    next_waiting_ = 1;  // parameters are next: early companions wait for the first one
  }
  /// The transmit queue can take a deferrable message without loss of a sensor message.
  bool has_room() const;
  /// A valid frame was received.
  void note_peer_frame(Time now);
  bool connected() const { return connected_; }
  /// Frames that the serial port rejected.
  std::uint32_t dropped() const { return dropped_; }
  /// The n of (1) or (2), of what follows the IMU.
  std::uint32_t decimation() const { return every_[kFast]; }
  /// Sends the crash record as soon as a companion is connected.
  void report_crash(const CrashRecord& record, bool rearmed);

 private:
  /// The kinds of samples; each waits for its own turn.
  enum Stream : std::uint8_t {
    kImu,
    kAttitude,
    kOutputs,
    kDiffPressure,
    kBaro,
    kMag,
    kRange,
    kBattery,
    kGnss,
    kRc,
    kStreams
  };
  /// What follows the IMU, and all others.
  enum Pace : std::uint8_t { kFast, kSlow, kPaces };
  using PerPace = std::array<std::uint32_t, kPaces>;
  static constexpr Pace pace(Stream kind) { return kind <= kOutputs ? kFast : kSlow; }
  /// (1) or (2), of offered_ in bytes per second. @param carried  C - R
  PerPace needed(std::uint32_t carried) const;

  std::size_t put(const link::Message& message);
  /// Whether a sample of that kind is to be sent.
  bool turn(Stream kind) { return every_[pace(kind)] == 1 || turn_of_many(kind); }
  bool turn_of_many(Stream kind);
  void send_sample(Stream kind, const link::Message& message);
  void measure(Time now);
  void tenth(Time now, bool fixed_wing);
  void send_waiting(Time now, const Waiting& w, Parameters& parameters, Log& log);
  void send_outputs(Time now, const hal::OutputValues& outputs);
  void send_rc(Time now, const hal::RcFrame& frame);
  int send_parameters(Parameters& parameters, int max_count);

  hal::Serial& serial_;
  link::Codec& codec_;
  link::HardError crash_{};
  Time last_peer_frame_{};
  Time next_tenth_{};
  std::uint32_t tenth_{0};  ///< Tenth of a second that began at the last one.
  Time measured_{};         ///< When offered_ began.
  std::uint32_t line_bytes_per_s_{0};
  PerPace offered_{};  ///< Bytes of samples, since measured_.
  PerPace every_{1, 1};
  std::uint32_t dropped_{0};
  std::array<std::uint16_t, kStreams> waited_{};  ///< Samples since the last one sent.
  std::array<std::uint8_t, kStreams> bytes_{};    ///< Bytes of the last frame of each kind.
  std::uint16_t next_listed_{static_cast<std::uint16_t>(kParamCount)};
  std::uint8_t imu_count_{0};
  std::uint8_t room_{0};          ///< Messages that this pass may still send.
  std::uint8_t passed_over_{0};   ///< Passes in which a message was due and postponed.
  std::uint8_t next_waiting_{3};  ///< Kind that was sent last.
  bool outputs_due_{false};
  bool rc_due_{false};
  bool status_due_{false};
  bool connected_{false};
  bool crash_waiting_{false};
};

}  // namespace rosflight::core
