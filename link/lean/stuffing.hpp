// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

/// Consistent Overhead Byte Stuffing (Cheshire & Baker, IEEE/ACM Trans. Networking 7(2), 1999) in
/// place, with FF as the byte that must not occur; for frames of at most 254 bytes, so that one
/// code byte in front is all the overhead.
///
/// The FFs are a chain: the code byte and each of them is replaced by 255 less the distance to the
/// next, the last by that to the end of the frame.
namespace rosflight::link::lean {

inline constexpr std::uint8_t kStart = 0xFF;
inline constexpr std::size_t kMaxStuffedBytes = 254;

using Word = std::size_t;

/// The highest bit of each byte of `word` that is FF. Exact: no carry leaves its byte.
constexpr Word starts_in(Word word) {
  constexpr Word kOnes = ~Word{0} / 0xFF;
  return ((word & (kOnes * 0x7F)) + kOnes) & word & (kOnes * 0x80);
}

/// The byte that stands for a distance to the next FF.
constexpr std::uint8_t code_of(std::size_t distance) {
  return static_cast<std::uint8_t>(kStart - distance);
}

/// A word from any address.
inline Word load(const std::uint8_t* bytes) {
  Word word{};
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

/// Not 0 if there is an FF among bytes[0, kBytes). Words may overlap; all are tested, because that
/// costs less than a branch for each.
template <std::size_t kBytes, std::size_t... kWords>
Word any_start(const std::uint8_t* bytes, std::index_sequence<kWords...>) {
  constexpr std::size_t kLast = kBytes - sizeof(Word);
  return (starts_in(load(bytes + (kWords * sizeof(Word) < kLast ? kWords * sizeof(Word) : kLast))) |
          ...);
}

/// frame[0] is for the code, frame[1, size) are the bytes to stuff.
[[gnu::noinline]] inline void stuff(std::uint8_t* frame, std::size_t size) {
  std::size_t code_at = 0;
  for (std::size_t at = 1; at < size; ++at) {
    if (frame[at] != kStart) continue;
    frame[code_at] = code_of(at - code_at);
    code_at = at;
  }
  frame[code_at] = code_of(size - code_at);
}

/// The same, fast for the usual frame, which has no FF.
template <std::size_t kSize>
void stuff(std::uint8_t* frame) {
  constexpr std::size_t kBytes = kSize - 1;
  if constexpr (kBytes >= sizeof(Word)) {
    constexpr std::size_t kWords = (kBytes + sizeof(Word) - 1) / sizeof(Word);
    if (any_start<kBytes>(frame + 1, std::make_index_sequence<kWords>{}) == 0) {
      frame[0] = code_of(kSize);
      return;
    }
  }
  stuff(frame, kSize);
}

/// Puts the FFs back; there is none in frame[0, size).
/// @returns false if the chain does not end where the frame does: then it was never stuffed so.
inline bool unstuff(std::uint8_t* frame, std::size_t size) {
  std::size_t at = code_of(frame[0]);
  while (at < size) {
    const std::size_t distance = code_of(frame[at]);
    frame[at] = kStart;
    at += distance;
  }
  return at == size;
}

}  // namespace rosflight::link::lean
