// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

namespace rosflight::boards::parts {

/// Composes one line in a buffer of the caller; what does not fit is cut off. Always terminated.
class Text {
 public:
  /// @param size  1 or more.
  Text(char* buffer, std::size_t size) : at_{buffer}, last_{buffer + size - 1} { *at_ = '\0'; }

  Text& add(const char* text) {
    while (*text != '\0' && at_ < last_) *at_++ = *text++;
    *at_ = '\0';
    return *this;
  }
  /// "0x" and `digits` digits.
  Text& hex(std::uint32_t value, int digits = 2) {
    char text[11] = "0x";
    for (int k = 0; k < digits; ++k)
      text[2 + k] = "0123456789ABCDEF"[value >> 4 * (digits - 1 - k) & 15u];
    text[2 + digits] = '\0';
    return add(text);
  }
  Text& number(std::uint32_t value) {
    char text[11];
    char* at = text + 10;
    *at = '\0';
    do {
      *--at = static_cast<char>('0' + value % 10);
      value /= 10;
    } while (value != 0);
    return add(at);
  }

 private:
  char* at_;
  char* last_;
};

}  // namespace rosflight::boards::parts
