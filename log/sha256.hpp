// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "log/byte_buffer.hpp"

namespace rosflight::log {

/// The 64 round constants of FIPS 180-4, section 4.2.2.
extern const std::array<std::uint32_t, 64> kSha256Rounds;

/// SHA-256 of FIPS 180-4, section 6.2, fed piece by piece. Fingerprints files while they are
/// written, so that two flights can be compared by one line. Not meant against an attacker with a
/// stopwatch. With the SHA instructions of an x86-64 processor (taken if it has them) some 2 GB/s,
/// otherwise 0.3 GB/s.
class Sha256 {
 public:
  using Digest = std::array<std::uint8_t, 32>;
  using State = std::array<std::uint32_t, 8>;
  /// Works `count` blocks of 64 bytes into the state.
  using Compress = void (*)(State& state, const std::uint8_t* blocks, std::size_t count);

  Sha256() : compress_(fastest()) {}
  /// For tests: a given implementation.
  explicit Sha256(Compress compress) : compress_(compress) {}

  static void compress_portable(State& state, const std::uint8_t* blocks, std::size_t count);
  /// The best this processor can do.
  static Compress fastest();

  void update(Bytes bytes);

  /// Digest of everything fed so far; the object can be fed on.
  Digest digest() const;

  /// The same as 64 lower-case hexadecimal digits, as sha256sum prints it.
  std::string hex() const;

 private:
  static constexpr std::size_t kBlock = 64;

  Compress compress_;
  State state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
               0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, kBlock> pending_{};
  std::uint64_t total_{0};
};

}  // namespace rosflight::log
