// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a frame file: refused with one line, or turned into parameters that are numbers.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "flight/vehicle/frame.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight;
  try {
    const auto document = config::Document::from_text(std::string(data, data + size), "fuzz");
    const flight::FrameConfig frame = flight::read_frame(document);
    for (const auto target : {flight::MixerTarget::kPrimary, flight::MixerTarget::kSecondary}) {
      for (const auto& entry : flight::mixer_parameters(frame, target)) {
        if (!std::isfinite(entry.value.number())) std::abort();
      }
    }
    if (std::isnan(flight::hover_check(frame).throttle)) std::abort();
  } catch (const config::Error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
