// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace rosflight::messages {

/// Serialises one message at a time in the common data representation ROS 2 uses: classic CDR,
/// little-endian (OMG DDSI-RTPS 2.3, section 10; CDR proper: OMG CORBA 3.3 part 2, section 9.3).
///
/// Four bytes of encapsulation {0, 1, 0, 0}; then each value, padded with zeros to a multiple of
/// its size counted from the end of those four. Strings: 32-bit length with the NUL, characters,
/// NUL. Arrays: the elements. Sequences: 32-bit count, elements. Structs: their members, no padding
/// of their own. The generated functions `serialize(CdrWriter&, message)` use it; memory is kept.
class CdrWriter {
  static_assert(std::endian::native == std::endian::little, "values are copied from memory");

 public:
  /// Starts a new message; forgets the last.
  void begin() { size_ = kEncapsulation; }

  /// Room for `size` bytes behind padding to a multiple of `alignment` (1, 2, 4 or 8): numbers that
  /// the caller stores at offsets it knows. Valid until the next call.
  std::uint8_t* run(std::size_t alignment, std::size_t size) {
    const std::size_t padding = (kEncapsulation - size_) & (alignment - 1);
    const std::size_t end = size_ + padding + size;
    if (end + sizeof kNoughts > bytes_.size()) [[unlikely]]
      bytes_.resize(2 * end + sizeof kNoughts);
    std::memcpy(bytes_.data() + size_, &kNoughts,
                sizeof kNoughts);  // the padding; the rest is overwritten
    size_ = end;
    return bytes_.data() + end - size;
  }

  void put(std::string_view text) {
    const auto length = static_cast<std::uint32_t>(text.size() + 1);
    std::uint8_t* const to = run(sizeof length, sizeof length + length);
    std::memcpy(to, &length, sizeof length);
    if (!text.empty()) std::memcpy(to + sizeof length, text.data(), text.size());
    to[sizeof length + text.size()] = 0;
  }

  /// How many elements of a sequence follow.
  void put_count(std::size_t size) {
    const auto count = static_cast<std::uint32_t>(size);
    std::memcpy(run(sizeof count, sizeof count), &count, sizeof count);
  }

  template <class T>
    requires std::is_arithmetic_v<T>
  void put(const std::vector<T>& values) {
    put_count(values.size());
    if (values.empty()) return;
    std::memcpy(run(sizeof(T), values.size() * sizeof(T)), values.data(),
                values.size() * sizeof(T));
  }

  /// The message so far; valid until the next call.
  std::span<const std::uint8_t> bytes() const { return {bytes_.data(), size_}; }

 private:
  static constexpr std::size_t kEncapsulation = 4;
  static constexpr std::uint64_t kNoughts = 0;

  std::vector<std::uint8_t> bytes_{0, 1, 0, 0};
  std::size_t size_{kEncapsulation};
};

/// What the generated functions store in a run.
namespace cdr {

/// A number, or an array of numbers, as it is in memory; a bool is one byte, 0 or 1.
template <class T>
void store(std::uint8_t* to, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::memcpy(to, &value, sizeof value);
}

inline void pad(std::uint8_t* to, std::size_t size) {
  std::memset(to, 0, size);
}

}  // namespace cdr

}  // namespace rosflight::messages
