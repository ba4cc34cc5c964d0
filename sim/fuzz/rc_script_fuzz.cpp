// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as an RC script: refused with one line, or played with channels that stay in range.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sim/rc/script.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight;
  const std::string text(data, data + size);
  sim::rc::Script script;
  try {
    script = sim::rc::read_script(config::Document::from_text(text, "fuzz").root());
  } catch (const config::Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    return 0;
  }
  sim::rc::Pilot pilot(script);
  hal::RcFrame frame;
  for (std::int64_t t = 0; t < 20'000'000; t += 50'000) {
    if (!pilot.step(sim::Time{t}, frame)) continue;
    for (const float channel : frame.channels) {
      if (!(channel >= -0.5F && channel <= 1.5F)) std::abort();
    }
  }
  return 0;
}
