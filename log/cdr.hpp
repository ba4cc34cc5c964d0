// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "log/byte_buffer.hpp"

namespace rosflight::log {

/// Serialises one message at a time in the common data representation ROS 2 uses: classic CDR,
/// little-endian (OMG DDSI-RTPS 2.3, section 10; CDR proper: OMG CORBA 3.3 part 2, section 9.3).
///
/// Four bytes of encapsulation {0, 1, 0, 0}; then each value, padded with zeros to a multiple of
/// its size counted from the end of those four. Strings: 32-bit length with the NUL, characters,
/// NUL. Arrays: the elements. Sequences: 32-bit count, elements. Structs: their members, no padding
/// of their own.
class CdrWriter {
 public:
  /// Starts a new message; forgets the last.
  void begin() {
    out_.clear();
    constexpr std::array<std::uint8_t, kEncapsulation> kLittleEndianCdr{0, 1, 0, 0};
    out_.append(kLittleEndianCdr);
  }

  template <class T>
    requires std::is_arithmetic_v<T>
  void put(T value) {
    align(sizeof(T));
    if constexpr (std::is_same_v<T, bool>) {
      out_.put(static_cast<std::uint8_t>(value ? 1 : 0));
    } else {
      out_.put(value);
    }
  }

  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    out_.append(as_bytes(text));
    out_.put(std::uint8_t{0});
  }

  template <class T, std::size_t kCount>
    requires(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>)
  void put(const std::array<T, kCount>& values) {
    put_elements(std::span<const T>(values));
  }

  template <class T>
    requires(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>)
  void put_sequence(std::span<const T> values) {
    put(static_cast<std::uint32_t>(values.size()));
    if (!values.empty()) put_elements(values);
  }

  /// The message so far; valid until the next call.
  Bytes bytes() const { return out_.bytes(); }

 private:
  static constexpr std::size_t kEncapsulation = 4;

  void align(std::size_t size) {
    const std::size_t padding = (0 - (out_.size() - kEncapsulation)) & (size - 1);
    if (padding != 0) std::memset(out_.extend(padding), 0, padding);
  }

  template <class T>
  void put_elements(std::span<const T> values) {
    align(sizeof(T));
    std::memcpy(out_.extend(values.size_bytes()), values.data(), values.size_bytes());
  }

  ByteBuffer out_;
};

}  // namespace rosflight::log
