// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a change of a running flight: understood, or refused with one line.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "config/strict_yaml.hpp"
#include "flight/steering.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight;
  static const flight::FlightSetup setup{flight::FlightChoice{}};
  static const flight::Flight running{setup};
  try {
    if (!flight::parse_change(std::string(data, data + size), running)) std::abort();
  } catch (const config::Error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
