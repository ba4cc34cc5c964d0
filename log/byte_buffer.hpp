// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>

namespace rosflight::log {

using Bytes = std::span<const std::uint8_t>;

inline Bytes as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()),
          text.size()};  // NOLINT(*-reinterpret-cast)
}

/// Growing little-endian output, without the zero fill of std::vector and without any alignment:
/// MCAP records are packed. (CDR, which aligns, is in cdr.hpp.) clear() keeps the memory.
class ByteBuffer {
  static_assert(std::endian::native == std::endian::little,
                "values are copied as they lie in memory");

 public:
  explicit ByteBuffer(std::size_t capacity = 256)
      : data_(std::make_unique_for_overwrite<std::uint8_t[]>(capacity)), capacity_(capacity) {}

  /// Room for `count` more bytes, contents unspecified; valid until the next call that adds bytes.
  std::uint8_t* extend(std::size_t count) {
    if (size_ + count > capacity_) grow(size_ + count);
    std::uint8_t* const end = data_.get() + size_;
    size_ += count;
    return end;
  }

  /// From here on up to `capacity` bytes take no more memory.
  void reserve(std::size_t capacity) {
    if (capacity > capacity_) grow(capacity);
  }

  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    std::memcpy(extend(sizeof value), &value, sizeof value);
  }

  void append(Bytes bytes) {
    if (!bytes.empty()) std::memcpy(extend(bytes.size()), bytes.data(), bytes.size());
  }

  /// A 32-bit length and the text, as MCAP strings are.
  void put_string(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    append(as_bytes(text));
  }

  /// Overwrites a value put earlier at `offset`.
  template <class T>
  void patch(std::size_t offset, T value) {
    std::memcpy(data_.get() + offset, &value, sizeof value);
  }

  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  Bytes bytes() const { return {data_.get(), size_}; }

 private:
  void grow(std::size_t wanted) {
    const std::size_t capacity = std::max(wanted, 2 * capacity_);
    auto data = std::make_unique_for_overwrite<std::uint8_t[]>(capacity);
    std::memcpy(data.get(), data_.get(), size_);
    data_ = std::move(data);
    capacity_ = capacity;
  }

  std::unique_ptr<std::uint8_t[]> data_;
  std::size_t size_{0};
  std::size_t capacity_;
};

}  // namespace rosflight::log
