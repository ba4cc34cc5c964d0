// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/ublox.hpp"

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kAckClass = 0x05, kAck = 0x01, kNak = 0x00;
constexpr std::uint8_t kCfg = 0x06;
constexpr std::uint8_t kPrt = 0x00, kMsg = 0x01, kRate = 0x08, kNav5 = 0x24, kTp5 = 0x31;

constexpr std::array<std::uint32_t, 6> kRates{9'600, 38'400, 57'600, 115'200, 230'400, 460'800};
constexpr std::uint8_t kRounds = 2;
constexpr std::uint8_t kAttempts = 3;
constexpr Time kSwitchTime{20'000};
constexpr Time kAnswerTime = hal::milliseconds(128);
constexpr Time kConfigureTime = hal::milliseconds(300);
constexpr Time kListenTime = hal::milliseconds(1200);
constexpr Time kSilence = hal::milliseconds(2000);
constexpr Time kArrivalDelay{22'000};
constexpr Time kPulseTimeout = hal::milliseconds(1100);
constexpr Time kSolutionTimeout = hal::milliseconds(300);

/// Class, id, and solutions per message; 0 is off.
struct Rated {
  std::uint8_t message_class, id, rate;
};
constexpr std::array<Rated, 10> kMessages{{{0x01, 0x07, 1},
                                           {0x01, 0x01, 0},
                                           {0x01, 0x03, 0},
                                           {0x01, 0x04, 0},
                                           {0x01, 0x11, 0},
                                           {0x01, 0x20, 0},
                                           {0x01, 0x35, 0},
                                           {0x0A, 0x09, 0},
                                           {0x0A, 0x0B, 0},
                                           {0x01, 0x02, 0}}};
constexpr std::uint8_t kFirstMessage = 3;  // behind CFG-RATE, CFG-NAV5, CFG-TP5
constexpr std::uint8_t kConfiguration = kFirstMessage + kMessages.size();

}  // namespace

Ublox::Ublox(UartPort& port, const Config& config)
    : Driver{"u-blox"}, port_{port}, config_{config} {}

bool Ublox::begin(Start how, Time now) {
  rate_ = 0;
  round_ = 0;
  answer_ = Answer::kNone;
  nmea_before_ = nmea_.frames();
  if (how == Start::kWarm) {
    set_baud(config_.baud);
    stage_ = Stage::kConfigure;
    message_ = 0;
    attempt_ = 0;
    send_configuration(now);
  } else {
    announce(now);
  }
  return true;
}

void Ublox::set_baud(std::uint32_t baud) {
  baud_ = baud;
  static_cast<void>(port_.set_format({baud, false, 1, false}));
}

// ---- the rate

void Ublox::announce(Time now) {
  stage_ = Stage::kAnnounce;
  set_baud(kRates[rate_]);
  static_cast<void>(send_port());
  until_ = now + kConfigureTime;  // if the port never becomes idle
}

void Ublox::next_rate(Time now) {
  if (++rate_ == kRates.size()) {
    rate_ = 0;
    ++round_;
  }
  if (round_ < kRounds) {
    announce(now);
  } else {
    rate_ = 0;
    listen(now);
  }
}

void Ublox::listen(Time now) {
  stage_ = Stage::kListen;
  set_baud(kRates[rate_]);
  until_ = now + kListenTime;
}

void Ublox::step_start(Time now) {
  switch (stage_) {
    case Stage::kAnnounce:
      if (!port_.idle() && now < until_) return;
      stage_ = Stage::kSwitch;
      until_ = now + kSwitchTime;
      return;
    case Stage::kSwitch:
      if (now < until_) return;
      set_baud(config_.baud);
      answer_ = Answer::kNone;
      static_cast<void>(send_port());
      stage_ = Stage::kAnswer;
      until_ = now + kAnswerTime;
      return;
    case Stage::kAnswer:
      if (answer_ == Answer::kAck) {
        stage_ = Stage::kConfigure;
        message_ = 0;
        attempt_ = 0;
        send_configuration(now);
      } else if (now >= until_) {
        next_rate(now);
      }
      return;
    case Stage::kListen:
      if (nmea_.frames() != nmea_before_) {
        note_answer();
        fail(now).add("sends NMEA at ").number(baud_).add(" baud, ignores UBX");
      } else if (now >= until_ && ++rate_ == kRates.size()) {
        fail(now).add("no answer");
      } else if (now >= until_) {
        listen(now);
      }
      return;
    case Stage::kConfigure:
      configure(now);
  }
}

// ---- the configuration

void Ublox::configure(Time now) {
  // Receivers refuse to switch off what they do not have.
  const bool optional = message_ > kFirstMessage;
  if (answer_ == Answer::kAck || (answer_ == Answer::kNak && optional)) {
    attempt_ = 0;
    if (++message_ == kConfiguration) {
      solution_at_ = now;
      started();
    } else {
      send_configuration(now);
    }
  } else if (answer_ == Answer::kNak) {
    fail(now).add("refuses message 0x06 ").hex(asked_);
  } else if (now >= until_ && ++attempt_ < kAttempts) {
    send_configuration(now);
  } else if (now >= until_) {
    fail(now).add("no answer to message 0x06 ").hex(asked_);
  }
}

void Ublox::send_configuration(Time now) {
  std::array<std::uint8_t, 36> payload{};
  answer_ = Answer::kNone;
  until_ = now + kConfigureTime;
  if (message_ == 0) {
    put_le16(&payload[0], config_.period_ms);
    put_le16(&payload[2], 1);  // each measurement gives a solution
    put_le16(&payload[4], 1);  // GPS time
    static_cast<void>(send(kRate, payload.data(), 6));
  } else if (message_ == 1) {
    put_le16(&payload[0], 0x0005);  // of what follows, model and fix mode count
    payload[2] = 8;                 // airborne, 4 g
    payload[3] = 3;                 // 2D or 3D
    static_cast<void>(send(kNav5, payload.data(), 36));
  } else if (message_ == 2) {
    put_le32(&payload[8], 1);      // Hz
    put_le32(&payload[12], 1);     // Hz when locked
    put_le32(&payload[16], 1000);  // us ...
    put_le32(&payload[20], 1000);  // ... and when locked
    put_le32(&payload[28], 0x7F);
    static_cast<void>(send(kTp5, payload.data(), 32));
  } else {
    const Rated& m = kMessages[static_cast<std::size_t>(message_ - kFirstMessage)];
    payload = {m.message_class, m.id, m.rate};
    static_cast<void>(send(kMsg, payload.data(), 3));
  }
}

bool Ublox::send_port() {
  std::array<std::uint8_t, 20> payload{};
  payload[0] = 1;                     // UART 1
  put_le32(&payload[4], 0x000008C0);  // 8N1
  put_le32(&payload[8], config_.baud);
  put_le16(&payload[12], 1);  // UBX in
  put_le16(&payload[14], 1);  // UBX out
  return send(kPrt, payload.data(), payload.size());
}

bool Ublox::send(std::uint8_t id, const std::uint8_t* payload, std::size_t size) {
  std::array<std::uint8_t, 36 + UbxFormat::kAround> frame{};
  asked_ = id;
  return port_.send(frame.data(), UbxFormat::wrap(kCfg, id, payload, size, frame.data()));
}

// ---- what arrives

void Ublox::receive(const std::uint8_t* data, std::size_t size, Time last) {
  for (std::size_t k = 0; k < size; ++k) {
    ubx_.take(data[k], [this, last](const std::uint8_t* frame, std::size_t bytes) {
      use_frame(frame, bytes, last);
    });
    nmea_.take(data[k], [](const std::uint8_t*, std::size_t) {});
  }
}

void Ublox::line_error(Time /*when*/) {
  ubx_.interrupt();
  nmea_.interrupt();
}

void Ublox::pulse(Time edge) {
  pulse_at_ = edge;
  have_pulse_ = true;
}

void Ublox::use_frame(const std::uint8_t* frame, std::size_t size, Time end) {
  const std::uint8_t message_class = frame[2];
  const std::uint8_t id = frame[3];
  const std::uint8_t* const payload = frame + 6;
  const std::size_t length = size - UbxFormat::kAround;
  if (message_class == kAckClass && length == 2 && payload[0] == kCfg && payload[1] == asked_) {
    answer_ = id == kAck ? Answer::kAck : id == kNak ? Answer::kNak : answer_;
  } else if (message_class == NavPvt::kClass && id == NavPvt::kId && length == NavPvt::kBytes &&
             state() == PartState::kRunning) {
    const NavPvt pvt = NavPvt::from(payload);
    if (!pvt.plausible) {
      count_error();
      return;
    }
    hal::GnssSample sample = pvt.sample;
    sample.stamp = stamp_of(pvt, end);
    static_cast<void>(samples_.put(sample));
    solution_at_ = end;
    well();
  }
}

/// The last pulse may belong to the second after the solution.
Time Ublox::stamp_of(const NavPvt& pvt, Time arrival) const {
  const bool usable =
      have_pulse_ && pvt.time_resolved && pvt.fix_ok && arrival - pulse_at_ < kPulseTimeout;
  if (usable) {
    Time stamp = pulse_at_ + Time{pvt.nano_ns / 1000};
    if (stamp > arrival) stamp -= hal::milliseconds(1000);
    if (arrival - stamp < kSolutionTimeout) return stamp;
  }
  return arrival - kArrivalDelay;
}

void Ublox::step_running(Time now) {
  if (now - solution_at_ < kSilence) return;
  if (nmea_.frames() != nmea_before_) {
    fail(now).add("sends NMEA at ").number(baud_).add(" baud");
  } else {
    fail(now).add("no solutions received");
  }
}

}  // namespace rosflight::boards::parts
