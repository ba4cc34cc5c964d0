// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <deque>

#include "firmware/boards/parts/models/part.hpp"

namespace rosflight::boards::parts::models {

struct GnssTruth {
  double latitude_deg{47.4}, longitude_deg{8.5};
  double height_msl_m{500.0};
  double velocity_ned_m_s[3]{};
  int fix{3};
  int satellites{14};
  double horizontal_accuracy_m{1.5}, vertical_accuracy_m{2.5},
      speed_accuracy_m_s{0.12};  ///< Reported.
};

/// A u-blox M9 on its UART: rate and protocol of the port, messages and their rates, dynamic model, pulse
/// per second, acknowledgements; NMEA until it is switched off. Solutions are those of the time of
/// validity and arrive `latency` later; bytes take their time on the wire.
class UbloxModel final : public UartPart {
 public:
  using Exposure = std::function<GnssTruth(Time)>;
  using Bytes = std::vector<std::uint8_t>;

  explicit UbloxModel(Exposure exposure) : exposure_{std::move(exposure)} { set_power(true); }

  void advance(Time now) override;
  Time next_event() const override;
  void set_power(bool on) override;
  void receive(std::uint8_t byte, std::uint32_t baud) override;
  bool take(std::uint8_t& byte, std::uint32_t& baud, Time& end) override;

  Line pulse;
  Time latency{hal::milliseconds(60)};
  std::uint32_t power_up_baud{38'400};
  bool nmea_only{false};  ///< Ignores what it is sent.
  bool knows_time{true};
  int refuse_id{-1};                   ///< Answers this CFG message with NAK.
  int lose_answers{0};                 ///< So many of the next acknowledgements are not sent.
  Time epoch{-1'700'000'000'000'000};  ///< Board time of 1970; whole seconds fall on whole seconds.

  std::uint32_t baud() const { return baud_; }
  int dynamic_model() const { return dynamic_model_; }
  std::uint32_t pulse_length_us() const { return pulse_locked_us_; }
  std::uint32_t pulse_length_unlocked_us() const { return pulse_unlocked_us_; }
  bool speaks_nmea() const { return nmea_out_; }
  /// Frames with right sums that it received.
  unsigned frames() const { return frames_; }

 private:
  void use_frame(const Bytes& frame);
  void configure(std::uint8_t id, const Bytes& payload);
  void send_solution(Time validity);
  void begin_pulse();
  void send_ubx(std::uint8_t message_class, std::uint8_t id, const Bytes& payload);
  void send(const Bytes& bytes);
  void end_pulse();

  Exposure exposure_;
  bool powered_{false};
  std::uint32_t baud_{};
  bool nmea_out_{true};
  bool pvt_{false};
  Time period_{};
  int dynamic_model_{0};
  std::uint32_t pulse_locked_us_{}, pulse_unlocked_us_{};
  unsigned frames_{0};
  Bytes in_;
  struct Sent {
    std::uint8_t byte;
    std::uint32_t baud;
    Time end;
  };
  std::deque<Sent> out_;
  std::deque<Time> solutions_;  ///< Times of validity whose messages are still to be sent.
  Time wire_free_{};
  Time now_{};
  Time next_solution_{};
  Time next_second_{};
  Time pulse_falls_{kNever};
};

}  // namespace rosflight::boards::parts::models
