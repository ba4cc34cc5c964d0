// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace rosflight::messages {

/// Takes the values out of a message that CdrWriter has written, one after another, in the order of
/// its definition. @throws std::runtime_error  the message ends too early.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> message) : bytes_{message} {}

  template <class T>
  void take(T& value) {
    std::memcpy(&value, run(sizeof value, sizeof value), sizeof value);
  }
  void take(std::string& text) {
    const std::uint32_t size = count();
    const auto* const from =
        reinterpret_cast<const char*>(run(1, size));  // NOLINT(*-reinterpret-cast)
    text.assign(from, size == 0 ? 0 : size - 1);
  }
  template <class T>
  void take(std::vector<T>& values) {
    const std::uint32_t size = count();
    const std::uint8_t* const from = run(size == 0 ? 1 : sizeof(T), size * sizeof(T));
    values.resize(size);
    if (size != 0) std::memcpy(values.data(), from, size * sizeof(T));
  }

 private:
  std::uint32_t count() {
    std::uint32_t size{};
    take(size);
    return size;
  }
  const std::uint8_t* run(std::size_t alignment, std::size_t size) {
    constexpr std::size_t kEncapsulation = 4;
    at_ += (kEncapsulation - at_) & (alignment - 1);
    if (at_ > bytes_.size() || size > bytes_.size() - at_) {
      throw std::runtime_error("a message ends too early");
    }
    at_ += size;
    return bytes_.data() + at_ - size;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_{4};
};

}  // namespace rosflight::messages
