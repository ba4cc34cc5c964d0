// SPDX-License-Identifier: BSD-3-Clause
#include "messages/utf8.hpp"

#include <cstdint>

namespace rosflight::messages {
namespace {

std::uint8_t byte_at(std::string_view text, std::size_t k) {
  return static_cast<std::uint8_t>(text[k]);
}

/// Bytes of the well-formed sequence at the start of `text`, 0 if there is none.
std::size_t sequence_length(std::string_view text) {
  const std::uint8_t lead = byte_at(text, 0);
  std::size_t length = 0;
  if (lead >= 0xC2 && lead <= 0xDF) length = 2;
  if (lead >= 0xE0 && lead <= 0xEF) length = 3;
  if (lead >= 0xF0 && lead <= 0xF4) length = 4;
  if (length == 0 || text.size() < length) return 0;
  // The second byte keeps out overlong forms, surrogates and what lies past U+10FFFF.
  std::uint8_t low = 0x80;
  std::uint8_t high = 0xBF;
  if (lead == 0xE0) low = 0xA0;
  if (lead == 0xED) high = 0x9F;
  if (lead == 0xF0) low = 0x90;
  if (lead == 0xF4) high = 0x8F;
  if (byte_at(text, 1) < low || byte_at(text, 1) > high) return 0;
  for (std::size_t k = 2; k < length; ++k) {
    if (byte_at(text, k) < 0x80 || byte_at(text, k) > 0xBF) return 0;
  }
  return length;
}

}  // namespace

std::string clean_utf8(std::string_view text) {
  text = text.substr(0, text.find('\0'));
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::uint8_t c = byte_at(text, 0);
    const bool plain = (c >= 0x20 && c < 0x7F) || c == '\t' || c == '\n';
    const std::size_t length = plain ? 1 : sequence_length(text);
    if (length == 0) {
      out += '?';
      text.remove_prefix(1);
    } else {
      out += text.substr(0, length);
      text.remove_prefix(length);
    }
  }
  return out;
}

}  // namespace rosflight::messages
