// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "log/byte_buffer.hpp"

struct evp_md_ctx_st;

namespace rosflight::log {

/// CRC-32 of ISO 3309 / IEEE 802.3, the one MCAP asks for, by zlib.
/// @param before  The value of the bytes before these; 0 at the start.
std::uint32_t crc32(Bytes bytes, std::uint32_t before = 0);

/// SHA-256 of FIPS 180-4, fed piece by piece, by OpenSSL (which uses the processor's instructions).
class Sha256 {
 public:
  Sha256();

  void update(Bytes bytes);

  /// Hash of everything fed so far as 64 lower-case hexadecimal digits, as sha256sum prints it. The
  /// object can be fed on.
  std::string hex() const;

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

}  // namespace rosflight::log
