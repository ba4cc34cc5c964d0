// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/models/ublox_model.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace rosflight::boards::parts::models {
namespace {

constexpr Time kSecond{1'000'000};

Time up_to(Time now, Time period) {
  return Time{(now.count() / period.count() + 1) * period.count()};
}

std::uint32_t u32(const UbloxModel::Bytes& b, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | b[at + k];
  return value;
}
void put(UbloxModel::Bytes& b, std::size_t at, std::size_t size, std::int64_t value) {
  for (std::size_t k = 0; k < size; ++k) {
    b[at + k] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * k));
  }
}

}  // namespace

void UbloxModel::set_power(bool on) {
  powered_ = on;
  baud_ = power_up_baud;
  nmea_out_ = true;
  pvt_ = false;
  period_ = kSecond;
  dynamic_model_ = 0;
  pulse_locked_us_ = 100'000;
  pulse_unlocked_us_ = 0;
  in_.clear();
  out_.clear();
  solutions_.clear();
  wire_free_ = now_;
  next_solution_ = up_to(now_, period_);
  next_second_ = up_to(now_, kSecond);
  end_pulse();
}

void UbloxModel::end_pulse() {
  if (pulse_ends_ != kNever && pulse) pulse(false, now_);
  pulse_ends_ = kNever;
}

Time UbloxModel::next_event() const {
  if (!powered_) return kNever;
  Time next = std::min({next_solution_, next_second_, pulse_ends_});
  if (!solutions_.empty()) next = std::min(next, solutions_.front() + latency);
  if (!out_.empty()) next = std::min(next, std::max(now_ + Time{1}, out_.front().end));
  return next;
}

void UbloxModel::advance(Time now) {
  while (powered_) {
    Time next = std::min({next_solution_, next_second_, pulse_ends_});
    if (!solutions_.empty()) next = std::min(next, solutions_.front() + latency);
    if (next > now) break;
    now_ = next;
    if (next == pulse_ends_) {
      end_pulse();
    } else if (next == next_second_) {
      next_second_ += kSecond;
      if (pulse && pulse_locked_us_ > 0) {
        pulse_ends_ = now_ + Time{pulse_locked_us_};
        pulse(true, now_);
      }
      if (nmea_out_) {
        const char* const sentence = "$GNTXT,01,01,02,ANTSTATUS=OK*25\r\n";
        send(Bytes(sentence, sentence + 33));
      }
    } else if (next == next_solution_) {
      next_solution_ += period_;
      solutions_.push_back(now_);
    } else {
      send_solution(solutions_.front());
      solutions_.pop_front();
    }
  }
  now_ = now;
}

bool UbloxModel::take(std::uint8_t& byte, std::uint32_t& baud, Time& end) {
  if (out_.empty() || out_.front().end > now_) return false;
  byte = out_.front().byte;
  baud = out_.front().baud;
  end = out_.front().end;
  out_.pop_front();
  return true;
}

/// A byte at another rate arrives as another byte.
void UbloxModel::receive(std::uint8_t byte, std::uint32_t baud) {
  if (!powered_ || nmea_only) return;
  in_.push_back(baud == baud_ ? byte : static_cast<std::uint8_t>(byte ^ 0x5A));
  while (in_.size() >= 2 && (in_[0] != 0xB5 || in_[1] != 0x62)) in_.erase(in_.begin());
  if (in_.size() < 6) return;
  const std::size_t length = in_[4] + in_[5] * 256u;
  if (in_.size() < length + 8) return;
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  for (std::size_t k = 2; k < length + 6; ++k) {
    a = static_cast<std::uint8_t>(a + in_[k]);
    b = static_cast<std::uint8_t>(b + a);
  }
  const Bytes frame(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(length + 8));
  in_.clear();
  if (frame[length + 6] == a && frame[length + 7] == b) use_frame(frame);
}

void UbloxModel::use_frame(const Bytes& frame) {
  ++frames_;
  if (frame[2] != 0x06) return;
  const std::uint8_t id = frame[3];
  const Bytes payload(frame.begin() + 6, frame.end() - 2);
  const bool refused = id == refuse_id;
  if (!refused) configure(id, payload);
  if (lose_answers > 0) {
    --lose_answers;
    return;
  }
  send_ubx(0x05, refused ? 0x00 : 0x01, {0x06, id});
}

void UbloxModel::configure(std::uint8_t id, const Bytes& payload) {
  if (id == 0x00 && payload.size() == 20) {
    baud_ = u32(payload, 8);
    nmea_out_ = (payload[14] & 2u) != 0;
  } else if (id == 0x01 && payload.size() == 3) {
    if (payload[0] == 0x01 && payload[1] == 0x07) pvt_ = payload[2] != 0;
  } else if (id == 0x08 && payload.size() == 6) {
    period_ = hal::milliseconds(std::int64_t{payload[0]} + std::int64_t{payload[1]} * 256);
    next_solution_ = up_to(now_, period_);
  } else if (id == 0x24 && payload.size() == 36) {
    const unsigned mask = payload[0] + payload[1] * 256u;
    if ((mask & 1u) != 0) dynamic_model_ = payload[2];
  } else if (id == 0x31 && payload.size() == 32) {
    pulse_unlocked_us_ = u32(payload, 16);
    pulse_locked_us_ = u32(payload, 20);
  } else {
    complain("configuration message of an unknown form");
  }
}

void UbloxModel::send_solution(Time validity) {
  if (!pvt_) return;
  const GnssTruth truth = exposure_(validity);
  const std::int64_t unix_us = (validity - epoch).count();
  const std::time_t second = unix_us / 1'000'000;
  std::tm utc{};
  gmtime_r(&second, &utc);
  Bytes p(92, 0);
  put(p, 4, 2, utc.tm_year + 1900);
  p[6] = static_cast<std::uint8_t>(utc.tm_mon + 1);
  p[7] = static_cast<std::uint8_t>(utc.tm_mday);
  p[8] = static_cast<std::uint8_t>(utc.tm_hour);
  p[9] = static_cast<std::uint8_t>(utc.tm_min);
  p[10] = static_cast<std::uint8_t>(utc.tm_sec);
  p[11] = knows_time ? 7 : 0;
  put(p, 16, 4, unix_us % 1'000'000 * 1000);
  p[20] = static_cast<std::uint8_t>(truth.fix);
  p[21] = truth.fix > 1 ? 1 : 0;
  p[23] = static_cast<std::uint8_t>(truth.satellites);
  put(p, 24, 4, std::lround(truth.longitude_deg * 1e7));
  put(p, 28, 4, std::lround(truth.latitude_deg * 1e7));
  put(p, 36, 4, std::lround(truth.height_msl_m * 1e3));
  put(p, 40, 4, 1500);
  put(p, 44, 4, 2500);
  for (std::size_t k = 0; k < 3; ++k)
    put(p, 48 + 4 * k, 4, std::lround(truth.velocity_ned_m_s[k] * 1e3));
  put(p, 68, 4, 120);
  send_ubx(0x01, 0x07, p);
}

void UbloxModel::send_ubx(std::uint8_t message_class, std::uint8_t id, const Bytes& payload) {
  Bytes frame{0xB5, 0x62, message_class, id, static_cast<std::uint8_t>(payload.size()), 0};
  frame.insert(frame.end(), payload.begin(), payload.end());
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  for (std::size_t k = 2; k < frame.size(); ++k) {
    a = static_cast<std::uint8_t>(a + frame[k]);
    b = static_cast<std::uint8_t>(b + a);
  }
  frame.push_back(a);
  frame.push_back(b);
  send(frame);
}

void UbloxModel::send(const Bytes& bytes) {
  wire_free_ = std::max(wire_free_, now_);
  for (const std::uint8_t byte : bytes) {
    wire_free_ += Time{std::llround(1e7 / baud_)};
    out_.push_back({byte, baud_, wire_free_});
  }
}

}  // namespace rosflight::boards::parts::models
