// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstring>

/// Copies texts of fixed size into and out of frames, for codecs.
namespace rosflight::link {

/// Copies a text and clears the bytes behind its first NUL.
template <std::size_t kSize>
void copy_text(const char* from, char* to) {
  std::memcpy(to, from, kSize);
  if (const void* const end = std::memchr(to, 0, kSize)) {
    const auto length = static_cast<std::size_t>(static_cast<const char*>(end) - to);
    std::memset(to + length, 0, kSize - length);
  }
}

/// The same for a text that must end with a NUL.
template <std::size_t kSize>
void copy_terminated(const char* from, char* to) {
  copy_text<kSize - 1>(from, to);
  to[kSize - 1] = 0;
}

}  // namespace rosflight::link
