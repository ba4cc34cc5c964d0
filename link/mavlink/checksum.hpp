// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

/// The checksum of a MAVLink frame: CRC-16/MCRF4XX, that is x^16 + x^12 + x^5 + 1, reflected,
/// starting from 0xFFFF, over length to payload and one more byte, the CRC_EXTRA of the message
/// (MAVLink 1.0 wire format).
///
/// It works on whole words and needs no table. Squaring a polynomial over GF(2) doubles its
/// exponents, so with P = x^16 + x^12 + x^5 + 1 and q = 1, 2, 4
///
///     P^q   = x^16q + x^12q + x^5q + 1,  hence with W = 16 q
///     H x^W = H x^(12q) + H x^(5q) + H   (mod P)                                          (1)
///
/// and a word H of W bits moves one word further by three shifts. The part of (1) that leaves the
/// word at the top is fed back in closed form: T = H + T/x^4q + T/x^11q (quotients) has the
/// solution
///
///     T = H + H/x^4q + H/x^8q + H/x^12q + H/x^11q                                         (2)
///
/// The last word is halved by (1) down to 16 bits. Cost: 15 instructions per word.
/// (Frobenius map: Lidl & Niederreiter, Finite Fields, 2nd ed., theorem 1.46.)
namespace rosflight::link::mavlink {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "frames are read and written in place");

/// H x^W mod P^q by (1) and (2). Reflected: the lowest bit of a word has the highest exponent.
template <typename Word>
constexpr Word fold(Word high) {
  constexpr unsigned kUnit = sizeof(Word) * 8 / 16;
  auto turned = static_cast<Word>(high ^ (high << (4 * kUnit)));
  turned = static_cast<Word>(turned ^ (turned << (8 * kUnit)) ^ (high << (11 * kUnit)));
  return static_cast<Word>(turned ^ (turned >> (5 * kUnit)) ^ (turned >> (12 * kUnit)));
}

inline constexpr std::uint16_t kChecksumStart = 0xFFFF;

/// One byte further, as the standard states it.
constexpr std::uint16_t checksum_step(std::uint16_t crc, std::uint8_t byte) {
  auto t = static_cast<std::uint8_t>(byte ^ (crc & 0xFFu));
  t = static_cast<std::uint8_t>(t ^ (t << 4));
  return static_cast<std::uint16_t>((crc >> 8) ^ (t << 8) ^ (t << 3) ^ (t >> 4));
}

/// A word from any address.
template <typename Word>
Word load(const std::uint8_t* bytes) {
  Word word{};
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

/// Checksum of data[0, size) and then `extra`, byte by byte.
inline std::uint16_t checksum_by_bytes(const std::uint8_t* data, std::size_t size,
                                       std::uint8_t extra) {
  std::uint16_t crc = kChecksumStart;
  for (std::size_t i = 0; i < size; ++i) crc = checksum_step(crc, data[i]);
  return checksum_step(crc, extra);
}

/// The same value; Word is std::uint64_t or std::uint32_t, size at least that of a Word.
template <typename Word>
[[gnu::always_inline]] inline std::uint16_t checksum_by(const std::uint8_t* data, std::size_t size,
                                                        std::uint8_t extra) {
  constexpr std::size_t kBytes = sizeof(Word);
  constexpr std::size_t kBehind = 3;  // the last word ends with `extra` and the x^16 of a CRC
  constexpr std::size_t kLast = kBytes - kBehind;
  // Zeros in front change nothing, so they fill up the first word. The two bytes of the start value
  // go to the first two bytes, and if there is only one before the first border, one behind it.
  const std::size_t zeros = (kLast - size) % kBytes;
  auto word = static_cast<Word>((load<Word>(data) ^ kChecksumStart) << (8 * zeros));
  word = fold(word) ^ (zeros == kBytes - 1 ? Word{kChecksumStart >> 8} : Word{0});
  const std::uint8_t* const end = data + size;
  for (const std::uint8_t* at = data + (kBytes - zeros); at != end - kLast; at += kBytes) {
    word = fold(static_cast<Word>(word ^ load<Word>(at)));
  }
  word ^= load<Word>(end - kBytes) >> (8 * kBehind);
  word ^= static_cast<Word>(static_cast<Word>(extra) << (8 * kLast));
  std::uint32_t half{};
  if constexpr (kBytes == 8) {
    half = fold(static_cast<std::uint32_t>(word)) ^ static_cast<std::uint32_t>(word >> 32);
  } else {
    half = word;
  }
  return static_cast<std::uint16_t>(fold(static_cast<std::uint16_t>(half)) ^ (half >> 16));
}

/// The same value with the word of this machine. Inline, because most of it folds away if size is
/// constant.
[[gnu::always_inline]] inline std::uint16_t checksum(const std::uint8_t* data, std::size_t size,
                                                     std::uint8_t extra) {
  using Word = std::conditional_t<sizeof(void*) == 8, std::uint64_t, std::uint32_t>;
  return size < sizeof(Word) ? checksum_by_bytes(data, size, extra)
                             : checksum_by<Word>(data, size, extra);
}

}  // namespace rosflight::link::mavlink
