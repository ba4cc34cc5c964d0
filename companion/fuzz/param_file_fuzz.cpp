// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a parameter file: read, or refused with one line; what is read survives being
// written.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "companion/parameter_file.hpp"
#include "config/strict_yaml.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight::companion;
  const std::string text(data, data + size);
  ParameterSet set;
  try {
    set = parse_parameters(text, "fuzz");
  } catch (const rosflight::config::Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) {
      std::abort();
    }
    return 0;
  }
  if (!diff(set, parse_parameters(format_parameters(set, text), "written")).empty()) {
    std::abort();
  }
  return 0;
}
