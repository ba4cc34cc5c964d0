// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "log/byte_buffer.hpp"

namespace rosflight::log {

/// CRC-32 of ISO 3309 / IEEE 802.3: reflected polynomial 0xEDB88320, initial value and final
/// inversion all ones; the one MCAP asks for. Check value: "123456789" -> 0xCBF43926. Eight bytes a
/// step from tables made at compile time (slicing-by-8: Kounavis and Berry, ISCC 2005). A few GB/s.
class Crc32 {
 public:
  void update(Bytes bytes);
  std::uint32_t value() const { return ~state_; }
  void reset() { state_ = ~std::uint32_t{0}; }

 private:
  std::uint32_t state_{~std::uint32_t{0}};
};

inline std::uint32_t crc32(Bytes bytes) {
  Crc32 crc;
  crc.update(bytes);
  return crc.value();
}

}  // namespace rosflight::log
