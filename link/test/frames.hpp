// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "link/codec.hpp"
#include "link/messages.hpp"

/// Frames as text and back, and small helpers for feeding a codec. Tests only.
namespace rosflight::link::test {

using Bytes = std::vector<std::uint8_t>;

inline Bytes from_hex(const std::string& text) {
  Bytes bytes;
  unsigned value = 0;
  int digits = 0;
  for (const char c : text) {
    if (std::isxdigit(static_cast<unsigned char>(c)) == 0) continue;
    value = value * 16 + static_cast<unsigned>(std::stoi(std::string(1, c), nullptr, 16));
    if (++digits == 2) {
      bytes.push_back(static_cast<std::uint8_t>(value));
      value = 0;
      digits = 0;
    }
  }
  return bytes;
}

inline std::string to_hex(const Bytes& bytes) {
  std::string text;
  std::array<char, 4> pair{};
  for (const std::uint8_t byte : bytes) {
    std::snprintf(pair.data(), pair.size(), "%02X", byte);
    text += text.empty() ? "" : " ";
    text += pair.data();
  }
  return text;
}

inline Bytes encoded(Codec& codec, const Message& message) {
  Frame frame;
  codec.encode(message, frame);
  return {frame.bytes.begin(), frame.bytes.begin() + static_cast<std::ptrdiff_t>(frame.size)};
}

/// Every message in `bytes`, handed over `chunk` bytes at a time.
inline std::vector<Message> decoded(Codec& codec, const Bytes& bytes,
                                    std::size_t chunk = SIZE_MAX) {
  std::vector<Message> messages;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = bytes.size() - at < chunk ? bytes.size() : at + chunk;
    while (at < end) {
      const Codec::Decoded step = codec.decode(bytes.data() + at, end - at);
      at += step.consumed;
      if (step.complete) messages.push_back(codec.message());
    }
  }
  return messages;
}

template <std::size_t kSize>
std::array<char, kSize> text(const std::string& from) {
  std::array<char, kSize> to{};
  for (std::size_t i = 0; i < kSize && i < from.size(); ++i) to[i] = from[i];
  return to;
}

}  // namespace rosflight::link::test
