// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace rosflight::base {

/// Bytes as text, by RFC 4648 section 4, padded, in one line.
inline std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  constexpr std::size_t kBytes = 3;  // become four digits of six bits
  constexpr unsigned kDigitBits = 6;
  std::string text;
  text.reserve((bytes.size() + kBytes - 1) / kBytes * 4);
  for (std::size_t at = 0; at < bytes.size(); at += kBytes) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < kBytes; ++k) {
      const char byte = at + k < bytes.size() ? bytes[at + k] : '\0';
      group = (group << 8U) | static_cast<std::uint8_t>(byte);
    }
    for (std::size_t k = 0; k <= kBytes; ++k) {
      const std::size_t digit = (group >> (kDigitBits * (kBytes - k))) & 63U;
      text += at + k <= bytes.size() ? kDigits[digit] : '=';
    }
  }
  return text;
}

}  // namespace rosflight::base
