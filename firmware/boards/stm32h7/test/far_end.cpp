// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/test/far_end.hpp"

#include <cstdio>
#include <cstdlib>

namespace rosflight::boards::stm32h7 {
namespace {

FarEnd the_far_end;

constexpr hal::Time kForEver = hal::milliseconds(3'600'000);

std::uint8_t digit(char c) {
  return static_cast<std::uint8_t>(c <= '9' ? c - '0' : c - 'a' + 10);
}

}  // namespace

FarEnd& far_end() {
  return the_far_end;
}

void sleep_for(hal::Time time) {
  const hal::Clock& clock = board_under_test().roles.clock;
  const hal::Time end = clock.now() + time;
  while (clock.now() < end) wait_for_interrupt();
}

std::string FarEnd::begin() {
  std::string line;
  do {  // the cable may not be connected yet
    tell("arguments");
  } while (!read_line(line, hal::milliseconds(50)));
  const std::size_t space = line.find(' ');
  const std::string after = line.substr(space + 1);
  after_ = after == "reset"        ? After::kReset
           : after == "bootloader" ? After::kBootloader
           : after == "power"      ? After::kPowerCycle
                                   : After::kPowerOn;
  return line.substr(0, space);
}

void FarEnd::tell(const std::string& order) {
  std::printf("\n@%s\n", order.c_str());
  std::fflush(stdout);
}

std::string FarEnd::ask(const std::string& order) {
  tell(order);
  std::string line;
  static_cast<void>(read_line(line, kForEver));
  return line;
}

FarEnd::Exposure FarEnd::show(const char* order, const void* data, std::size_t size) {
  const std::string times = ask(order + (' ' + hex(data, size)));
  char* second = nullptr;
  const long long begin = std::strtoll(times.c_str(), &second, 10);
  return {hal::Time{begin}, hal::Time{std::strtoll(second, nullptr, 10)}};
}

FarEnd::Bytes FarEnd::report() {
  const std::string line = ask("report");
  Bytes bytes;
  for (std::size_t k = 0; k + 1 < line.size(); k += 2) {
    bytes.push_back(static_cast<std::uint8_t>(digit(line[k]) << 4 | digit(line[k + 1])));
  }
  return bytes;
}

void FarEnd::announce_reset() {
  constexpr hal::Time kStartUpOfParts = hal::milliseconds(400);  // ADIS16500: 310 ms
  sleep_for(kStartUpOfParts);
  ask("restart");
}

void FarEnd::end(const std::string& order) {
  tell(order);
  for (;;) wait_for_interrupt();
}

std::string FarEnd::hex(const void* data, std::size_t size) {
  const auto* const bytes = static_cast<const std::uint8_t*>(data);
  std::string text;
  for (std::size_t k = 0; k < size; ++k) {
    text += "0123456789abcdef"[bytes[k] >> 4u];
    text += "0123456789abcdef"[bytes[k] & 15u];
  }
  return text;
}

/// Collects the line over several calls. @returns false if it was not complete in time.
bool FarEnd::read_line(std::string& line, hal::Time wait) {
  const hal::Board& roles = board_under_test().roles;
  const hal::Time end = roles.clock.now() + wait;
  while (roles.clock.now() < end) {
    std::uint8_t byte = 0;
    if (roles.serial.read(&byte, 1) == 0) {
      wait_for_interrupt();
    } else if (byte == '\n') {
      line.swap(begun_);
      begun_.clear();
      return true;
    } else {
      begun_ += static_cast<char>(byte);
    }
  }
  return false;
}

}  // namespace rosflight::boards::stm32h7
