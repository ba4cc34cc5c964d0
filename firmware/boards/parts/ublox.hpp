// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/boards/parts/ubx.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// u-blox M9 (and M8) receiver on a UART. The driver finds the rate at which the receiver listens, sets
/// its own, and configures UBX alone, 10 solutions per second, NAV-PVT, the airborne model up to 4 g,
/// and the pulse per second. A receiver that sends NMEA and does not answer is named in the message.
///
/// A warm start skips the search for the rate.
///
/// Stamp: the last pulse plus the solution's fraction of a second, if the receiver knows the time, has a
/// fix, and the pulse is less than 1.1 s old; otherwise the arrival of the message less 22 ms.
class Ublox final : public Driver, public hal::Source<hal::GnssSample>, public ByteReceiver {
 public:
  struct Config {
    std::uint32_t baud{115'200};
    std::uint16_t period_ms{100};
  };

  Ublox(UartPort& port, const Config& config);

  void receive(const std::uint8_t* data, std::size_t size, Time last) override;
  void line_error(Time when) override;
  /// Rising edge of the pulse per second. Bus context. A board without the line never calls it.
  void pulse(Time edge);
  /// Main loop.
  bool poll(hal::GnssSample& sample) override { return samples_.take(sample); }

  /// Damaged frames since construction.
  std::uint32_t damaged() const { return ubx_.damaged(); }

 private:
  enum class Stage : std::uint8_t {
    kAnnounce,  ///< The new rate is being sent at a rate the receiver may have ...
    kSwitch,    ///< ... it has left the wire; the receiver changes its rate ...
    kAnswer,    ///< ... and is asked at the new one.
    kListen,    ///< No rate was answered: is there NMEA at this one?
    kConfigure  ///< One message after the other, each acknowledged.
  };
  enum class Answer : std::uint8_t { kNone, kAck, kNak };

  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void announce(Time now);
  void next_rate(Time now);
  void listen(Time now);
  void configure(Time now);
  void send_configuration(Time now);
  bool send(std::uint8_t id, const std::uint8_t* payload, std::size_t size);
  bool send_port();
  void use_frame(const std::uint8_t* frame, std::size_t size, Time end);
  Time stamp_of(const NavPvt& pvt, Time arrival) const;
  void set_baud(std::uint32_t baud);

  UartPort& port_;
  Config config_;
  Stage stage_{Stage::kAnnounce};
  std::uint8_t rate_{0};  ///< Which of the rates is being tried.
  std::uint8_t round_{0};
  std::uint8_t message_{0};  ///< Which of the configuration.
  std::uint8_t attempt_{0};
  std::uint8_t asked_{0};  ///< Id of the message that awaits an answer.
  std::uint32_t baud_{0};  ///< That of the port.
  Answer answer_{Answer::kNone};
  Time until_{};
  Time solution_at_{};
  Time pulse_at_{};
  bool have_pulse_{false};
  std::uint32_t nmea_before_{0};
  Framer<UbxFormat> ubx_;
  Framer<NmeaFormat> nmea_;
  Handover<hal::GnssSample, 2> samples_;
};

}  // namespace rosflight::boards::parts
