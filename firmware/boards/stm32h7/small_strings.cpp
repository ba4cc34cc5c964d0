// SPDX-License-Identifier: BSD-3-Clause
// Functions of the C library for short texts and blocks. Those of newlib are made for long ones: together they are
// 1000 bytes longer, and copy byte by byte what does not lie at multiples of four. Compiled as for a machine without a
// library, so that a loop does not become a call of its own function.
#include <cstddef>
#include <cstdint>

namespace {

/// Four bytes at any address: the processor reads and writes them at once in all memory that is not a device's.
std::uint32_t word_at(const void* address) {
  std::uint32_t word = 0;
  __builtin_memcpy(&word, address, sizeof word);
  return word;
}
void set_word(void* address, std::uint32_t word) {
  __builtin_memcpy(address, &word, sizeof word);
}

constexpr std::size_t kWord = sizeof(std::uint32_t);

}  // namespace

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

void* memmove(void* to, const void* from, std::size_t count) {
  auto* out = static_cast<unsigned char*>(to);
  const auto* in = static_cast<const unsigned char*>(from);
  if (reinterpret_cast<std::uintptr_t>(out) - reinterpret_cast<std::uintptr_t>(in) >= count) {
    for (; count >= kWord; count -= kWord, out += kWord, in += kWord) set_word(out, word_at(in));
    for (; count > 0; --count) *out++ = *in++;
  } else {  // the last bytes first: the ranges overlap
    for (; count >= kWord; count -= kWord)
      set_word(out + count - kWord, word_at(in + count - kWord));
    for (; count > 0; --count) out[count - 1] = in[count - 1];
  }
  return to;
}

void* memcpy(void* to, const void* from, std::size_t count) {
  return memmove(to, from, count);
}

void* memset(void* to, int value, std::size_t count) {
  auto* out = static_cast<unsigned char*>(to);
  const auto byte = static_cast<unsigned char>(value);
  const std::uint32_t word = byte * 0x0101'0101u;
  for (; count >= kWord; count -= kWord, out += kWord) set_word(out, word);
  for (; count > 0; --count) *out++ = byte;
  return to;
}
}
