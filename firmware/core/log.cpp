// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/log.hpp"

#include <cmath>

namespace rosflight::core {

void Text::put(char c) {
  if (length_ + 1 < chars_.size()) chars_[length_++] = c;
}

Text& Text::add(const char* text) {
  return add(text, chars_.size());
}

Text& Text::add(const link::ParamName& name) {
  return add(name.data(), name.size());
}

/// As many characters as there are before a NUL, at most `size`.
Text& Text::add(const char* text, std::size_t size) {
  const std::size_t room = chars_.size() - 1 - length_;
  const std::size_t most = size < room ? size : room;
  char* const to = &chars_[length_];
  std::size_t k = 0;
  for (; k < most && text[k] != '\0'; ++k) to[k] = text[k];
  length_ += k;
  return *this;
}

Text& Text::add(std::int32_t value) {
  std::array<char, 11> digits{};
  std::size_t n = 0;
  auto rest = static_cast<std::uint32_t>(value);
  if (value < 0) {
    put('-');
    rest = 0u - rest;
  }
  do {
    digits[n++] = static_cast<char>('0' + rest % 10);
    rest /= 10;
  } while (rest != 0);
  while (n > 0) put(digits[--n]);
  return *this;
}

Text& Text::add_hex(std::uint32_t value) {
  add("0x");
  int shift = 28;
  while (shift > 0 && ((value >> shift) & 0xFu) == 0) shift -= 4;
  for (; shift >= 0; shift -= 4) put("0123456789ABCDEF"[(value >> shift) & 0xFu]);
  return *this;
}

Text& Text::add(float value, int decimals) {
  if (std::isnan(value)) return add("nan");
  if (value < 0.0f) {
    put('-');
    value = -value;
  }
  if (value > 2.0e9f) return add("huge");
  float scale = 1.0f;
  for (int k = 0; k < decimals; ++k) scale *= 10.0f;
  auto whole = static_cast<std::uint32_t>(value);
  auto fraction =
      static_cast<std::uint32_t>(std::lround((value - static_cast<float>(whole)) * scale));
  if (static_cast<float>(fraction) >= scale) {
    ++whole;
    fraction = 0;
  }
  add(static_cast<std::int32_t>(whole));
  if (decimals == 0) return *this;
  put('.');
  for (auto digit = static_cast<std::uint32_t>(scale) / 10; digit > 0; digit /= 10) {
    put(static_cast<char>('0' + fraction / digit % 10));
  }
  return *this;
}

void Log::push(Severity severity, const Text& text) {
  if (count_ == kCapacity) {
    first_ = static_cast<std::uint8_t>((first_ + 1) % kCapacity);
    --count_;
    ++lost_;
  }
  ring_[(first_ + count_) % kCapacity] = {severity, text.chars()};
  ++count_;
}

link::StatusText Log::pop() {
  const link::StatusText text = ring_[first_];
  first_ = static_cast<std::uint8_t>((first_ + 1) % kCapacity);
  --count_;
  return text;
}

}  // namespace rosflight::core
