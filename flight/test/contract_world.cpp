// SPDX-License-Identifier: BSD-3-Clause
#include "flight/test/contract_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace rosflight::flight::testing {
namespace {

using boards::stm32h7::ChipOrder;
using boards::stm32h7::FromChip;
using boards::stm32h7::ToChip;

constexpr std::int64_t kSecond_us = 1'000'000, kStep_us = 1000, kTimeout_us = 60 * kSecond_us;
constexpr std::int64_t kEnumerated_us =
    400'000;  // the host has found the device and opened its port
constexpr std::uint32_t kBaud = 921'600;
constexpr int kHexadecimal = 16;

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<std::uint8_t>(c);
    text += "0123456789abcdef"[byte >> 4U];
    text += "0123456789abcdef"[byte & 15U];
  }
  return text;
}

std::vector<std::uint8_t> bytes_of(const std::string& hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t k = 0; k + 1 < hex.size(); k += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(k, 2), nullptr, kHexadecimal)));
  }
  return bytes;
}

/// Samples have one layout on both sides, as FirmwareGlance has.
template <class Sample>
void read_sample(const std::string& hex, Sample& sample) {
  const std::vector<std::uint8_t> bytes = bytes_of(hex);
  ASSERT_EQ(bytes.size(), sizeof sample);
  std::memcpy(&sample, bytes.data(), sizeof sample);
}

}  // namespace

ContractWorld::ContractWorld(const boards::stm32h7::ChipProcess::Options& image) : chip_{image} {
  chip_.start();
  ToChip& world = chip_.to_chip();
  world.link_baud = kBaud;
  world.has_imu = world.has_mag = world.has_baro = 1;
  world.has_diff_pressure = world.has_gnss = world.has_battery = 1;
}

ContractWorld::Result ContractWorld::run(const std::string& option, Cable cable) {
  option_ = option;
  after_ = "start";
  cable_ = cable;
  output_.clear();
  ended_.clear();
  problem_.clear();
  begun_ = restart_expected_ = marked_ = false;
  searched_ = 0;
  power_on();
  const std::int64_t timeout_us = now_us_ + kTimeout_us;
  while (ended_.empty() && problem_.empty()) {
    step();
    take_output();
    if (now_us_ >= timeout_us) problem_ = "no end within 60 s";
  }
  if (problem_.empty() && ended_ != "0") problem_ = "failed";
  return {output_, problem_};
}

/// The world in which the board starts is at rest.
void ContractWorld::power_on() {
  ToChip& world = chip_.to_chip();
  world.order = ChipOrder::kPowerOn;
  world.imu = hal::ImuSample{};
  world.imu.accel_m_s2 = {0.0F, 0.0F, -9.8F};
  world.mag = hal::MagSample{};
  world.baro = {{}, 100'000.0F, 288.15F};
  world.diff_pressure = {{}, 0.0F, 288.15F};
  world.gnss = hal::GnssSample{};
  world.battery = hal::BatterySample{};
  powered_at_us_ = now_us_;
  to_board_.clear();
}

void ContractWorld::step() {
  ToChip& world = chip_.to_chip();
  world.usb_plugged = static_cast<std::uint8_t>(cable_ == Cable::kUsb);
  const std::size_t count = std::min(to_board_.size(), world.link.size());
  std::copy_n(to_board_.begin(), count, world.link.begin());
  to_board_.erase(to_board_.begin(), to_board_.begin() + static_cast<std::ptrdiff_t>(count));
  world.link_count = static_cast<std::uint32_t>(count);
  world.time_us = now_us_;
  now_us_ += kStep_us;
  world.until_us = now_us_;
  chip_.exchange();
  world.order = ChipOrder::kStep;
  world.has_rc = 0;
  if (chip_.from_chip().in_bootloader == 0) return;
  // The bootloader knows nothing of tests; the power ends it.
  after_ = "bootloader";
  power_on();
}

/// Takes orders out of what came.
void ContractWorld::take_output() {
  const FromChip& from = chip_.from_chip();
  output_.append(from.link.begin(), from.link.begin() + from.link_count);
  for (;;) {
    const std::size_t begin = output_.find("\n@", searched_);
    const std::size_t end = begin == std::string::npos ? begin : output_.find('\n', begin + 1);
    if (end == std::string::npos) return;
    if (output_[begin + 2] == '@') {  // GoogleTest shows differences so
      searched_ = begin + 1;
      continue;
    }
    const std::string order = output_.substr(begin + 2, end - begin - 2);
    output_.erase(begin, end - begin + 1);
    searched_ = begin;
    carry_out(order);
  }
}

void ContractWorld::carry_out(const std::string& order) {
  const std::size_t space = order.find(' ');
  const std::string name = order.substr(0, space);
  const std::string rest = space == std::string::npos ? "" : order.substr(space + 1);
  if (name == "arguments") {
    begin_image();
  } else if (name == "show") {
    const std::size_t kind = rest.find(' ');
    show(rest.substr(0, kind), rest.substr(kind + 1));
  } else if (name == "frame") {
    read_sample(rest, chip_.to_chip().rc);
    chip_.to_chip().has_rc = 1;
    answer_times(now_us_);
  } else if (name == "send") {
    to_board_ = bytes_of(rest);
  } else if (name == "mark") {
    marked_ = true;
    mark_ = searched_;
  } else if (name == "report") {
    const std::size_t from = marked_ ? mark_ : searched_;
    answer(hex(output_.substr(from, searched_ - from)));
    output_.erase(from, searched_ - from);
    searched_ = from;
    marked_ = false;
  } else if (name == "restart") {
    restart_expected_ = true;
    resets_ = chip_.from_chip().resets;
    after_ = "reset";
    answer("go");
  } else if (name == "power") {
    restart_expected_ = true;
    after_ = "power";
    power_on();
  } else if (name == "end") {
    ended_ = rest;
  } else if (name != "wait") {
    problem_ = "unknown order " + order;
  }
}

void ContractWorld::begin_image() {
  if (cable_ == Cable::kUsb && now_us_ - powered_at_us_ < kEnumerated_us) return;
  const bool reset = chip_.from_chip().resets > resets_;
  if (begun_ && !restart_expected_) problem_ = "the board restarted by itself";
  if (begun_ && after_ != "power" && !reset) problem_ = "no reset before the restart";
  begun_ = true;
  restart_expected_ = false;
  answer(option_ + ' ' + after_);
}

void ContractWorld::show(const std::string& kind, const std::string& bytes) {
  ToChip& world = chip_.to_chip();
  std::int64_t valid_us = now_us_;
  if (kind == "imu") {
    read_sample(bytes, world.imu);
  } else if (kind == "mag") {
    read_sample(bytes, world.mag);
  } else if (kind == "baro") {
    read_sample(bytes, world.baro);
  } else if (kind == "diff_pressure") {
    read_sample(bytes, world.diff_pressure);
  } else if (kind == "battery") {
    read_sample(bytes, world.battery);
  } else if (kind == "gnss") {
    // Its pulses are those of whole seconds, in the time of the world as in UTC.
    read_sample(bytes, world.gnss);
    valid_us = now_us_ / kSecond_us * kSecond_us + world.gnss.unix_ns / 1000;
    world.gnss.stamp = hal::Time{valid_us};
  } else {
    problem_ = "unknown kind of sample " + kind;
  }
  answer_times(valid_us);
}

void ContractWorld::answer(const std::string& line) {
  to_board_.insert(to_board_.end(), line.begin(), line.end());
  to_board_.push_back('\n');
}

/// On the board's clock. An order takes effect with the next step, which begins now.
void ContractWorld::answer_times(std::int64_t valid_us) {
  const std::int64_t zero_us = chip_.from_chip().clock_zero_us;
  answer(std::to_string(now_us_ - zero_us) + ' ' + std::to_string(valid_us - zero_us));
}

}  // namespace rosflight::flight::testing
