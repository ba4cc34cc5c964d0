// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a YAML document, the first line of them as an override: refused with one line, or
// written out as a document that reads back the same.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "config/strict_yaml.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight;
  const std::string text(data, data + size);
  const auto end = text.find('\n');
  const auto check = [](bool good) {
    if (!good) std::abort();
  };
  std::string written;
  try {
    config::Document document = config::Document::from_text(text, "fuzz");
    if (end != std::string::npos && text.find('=') < end) document.set(text.substr(0, end));
    written = document.text();
  } catch (const config::Error& error) {
    check(std::string_view(error.what()).find('\n') == std::string_view::npos);
    return 0;
  }
  check(config::Document::from_text(written, "again").text() == written);  // must not throw
  return 0;
}
