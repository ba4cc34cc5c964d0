// SPDX-License-Identifier: BSD-3-Clause
// Functions of the C library for short texts, a byte at a time: those of newlib, made for long ones, are 360 bytes
// longer. Compiled as for a machine without a library, so that a loop does not become a call of its own function.
#include <cstddef>

extern "C" {
std::size_t strlen(const char* text) {
  const char* end = text;
  while (*end != 0) ++end;
  return static_cast<std::size_t>(end - text);
}

int strncmp(const char* a, const char* b, std::size_t count) {
  for (; count > 0; --count, ++a, ++b) {
    const int difference = static_cast<unsigned char>(*a) - static_cast<unsigned char>(*b);
    if (difference != 0 || *a == 0) return difference;
  }
  return 0;
}

int memcmp(const void* a, const void* b, std::size_t count) {
  const auto* left = static_cast<const unsigned char*>(a);
  const auto* right = static_cast<const unsigned char*>(b);
  for (; count > 0; --count, ++left, ++right) {
    if (*left != *right) return *left - *right;
  }
  return 0;
}
}
