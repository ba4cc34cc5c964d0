// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/models/adis16500_model.hpp"

#include <algorithm>

#include "base/constants.hpp"

namespace rosflight::boards::parts::models {
namespace {

constexpr Time kSync{500};
constexpr Time kDelay{1510};
constexpr Time kStartUp = hal::milliseconds(310);
constexpr Time kStall{16};
constexpr std::uint8_t kMisc = 0x60, kDecimation = 0x64, kProduct = 0x72, kStatus = 0x02;

}  // namespace

void Adis16500Model::reset() {
  registers_.fill(0);
  registers_[kMisc / 2] = 0x00C1;
  ready_ = now_ + kStartUp;
  next_ = ready_;
  averaged_ = 0;
  sum_.fill(0.0);
  counter_ = 0;
}

void Adis16500Model::set_power(bool on) {
  powered_ = on;
  if (on) reset();
}

void Adis16500Model::reset_pin(bool high) {
  if (high && !pin_high_) reset();
  pin_high_ = high;
}

void Adis16500Model::advance(Time now) {
  while (runs() && next_ <= now) {
    now_ = next_;
    next_ += kSync;
    sample();
  }
  now_ = now;
  if (!runs()) next_ = std::max(next_, now_ + kSync);  // no clock, no samples to catch up with
}

double Adis16500Model::delay_us() const {
  const double averaged = registers_[kDecimation / 2] + 1.0;
  const double oldest_us = (averaged - 1.0) * static_cast<double>(kSync.count());
  return static_cast<double>(kDelay.count()) + oldest_us / 2.0;
}

void Adis16500Model::sample() {
  const ImuTruth truth = exposure_(now_ - kDelay);
  for (std::size_t k = 0; k < 3; ++k) {
    sum_[k] += truth.gyro_rad_s[k] * base::kDegPerRad / 0.1 * 65536.0;
    sum_[3 + k] += truth.accel_m_s2[k] / 0.01225 * 65536.0;
  }
  const unsigned decimation = registers_[kDecimation / 2] + 1u;
  if (++averaged_ < decimation) {
    if (averaged_ == 1 && line && !no_edges) line(false, now_);
    return;
  }
  for (std::size_t k = 0; k < 6; ++k) {
    const double mean = std::clamp(sum_[k] / averaged_, -2147483648.0, 2147483647.0);
    values_[k] = static_cast<std::int32_t>(std::llround(mean));
  }
  temperature_ = to_counts((truth.temperature_K - 273.15) / 0.1);
  sum_.fill(0.0);
  averaged_ = 0;
  ++counter_;
  ++samples;
  if (line && !no_edges) line(true, now_);
}

void Adis16500Model::select(bool selected) {
  if (selected && !selected_) {
    if (now_ - last_word_ < kStall) complain("less than 16 us between words");
    count_ = 0;
  }
  if (!selected && selected_) {
    last_word_ = now_;
    if (count_ != 2 && count_ != 34)
      complain("selected for a number of bytes that is no word and no burst");
  }
  selected_ = selected;
}

std::uint16_t Adis16500Model::read(std::uint8_t address) const {
  if (address == kProduct) return product;
  if (address == kStatus) return status;
  return registers_[address / 2 % registers_.size()];
}

std::uint8_t Adis16500Model::exchange(std::uint8_t out) {
  const std::size_t k = count_++;
  if (!powered_ || mute || !selected_) return 0xFF;
  if (now_ < ready_ || !pin_high_) {
    if (k == 0) complain("word during the start-up");
    return 0xFF;
  }
  if (k >= 2) return k - 2 < burst_.size() ? burst_[k - 2] : std::uint8_t{0};
  const auto answer = static_cast<std::uint8_t>(k == 0 ? answer_ >> 8 : answer_ & 0xFFu);
  word_[k] = out;
  if (k == 0) return answer;
  if ((word_[0] & 0x80u) != 0) {
    const std::uint8_t address = word_[0] & 0x7Fu;
    std::uint16_t& value = registers_[address / 2];
    if (lose_writes > 0) {
      --lose_writes;
    } else {
      value = static_cast<std::uint16_t>((address & 1u) != 0 ? (value & 0x00FFu) | word_[1] * 256u
                                                             : (value & 0xFF00u) | word_[1]);
    }
  } else if (word_[0] == 0x68) {
    fill_burst();
  } else {
    answer_ = read(word_[0]);
  }
  return answer;
}

void Adis16500Model::fill_burst() {
  burst_.clear();
  const auto put = [this](unsigned value) {
    burst_.push_back(static_cast<std::uint8_t>(value >> 8 & 0xFFu));
    burst_.push_back(static_cast<std::uint8_t>(value & 0xFFu));
  };
  put(status);
  const bool long_words = (registers_[kMisc / 2] & 0x0200u) != 0;
  for (const std::int32_t value : values_) {
    const auto bits = static_cast<std::uint32_t>(value);
    if (long_words) put(bits & 0xFFFFu);
    put(bits >> 16);
  }
  put(static_cast<std::uint16_t>(temperature_));
  put(counter_);
  unsigned sum = wrong_checksum ? 1 : 0;
  for (const std::uint8_t byte : burst_) sum += byte;
  put(sum & 0xFFFFu);
}

}  // namespace rosflight::boards::parts::models
