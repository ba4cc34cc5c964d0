// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

/// Access to registers. The constants themselves are generated from registers.csv into
/// "firmware/boards/stm32h7/registers.hpp"; their names are those of the reference manual.
namespace rosflight::boards::stm32h7 {

/// Bits `lsb` to `lsb + width - 1` of a register.
struct Field {
  std::uint32_t lsb;
  std::uint32_t width;

  // Inlined, they are one instruction or a constant: made small, the compiler would call them.
  [[gnu::always_inline]] constexpr std::uint32_t mask() const {
    return (width == 32 ? ~0u : (1u << width) - 1u) << lsb;
  }
  /// The value in its place; bits that do not fit are cut off.
  [[gnu::always_inline]] constexpr std::uint32_t operator()(std::uint32_t value) const {
    return (value << lsb) & mask();
  }
  [[gnu::always_inline]] constexpr std::uint32_t of(std::uint32_t word) const {
    return (word & mask()) >> lsb;
  }
};

/// One peripheral of a kind: base address, and the bit of RCC that opens its clock gate
/// (gate 0: it has none).
struct Instance {
  std::uint32_t base;
  std::uint16_t gate;
  std::uint8_t gate_bit;

  constexpr bool operator==(const Instance& other) const { return base == other.base; }
};

/// What the hardware has there: the one place where a number becomes a pointer.
template <typename T>
T& memory_at(std::uintptr_t address) {
  return *reinterpret_cast<T*>(address);  // NOLINT(performance-no-int-to-ptr)
}

inline volatile std::uint32_t& reg(const Instance& instance, std::uint32_t offset) {
  return memory_at<volatile std::uint32_t>(instance.base + offset);
}
/// Register access of 8 bits, for data registers with such frames.
inline volatile std::uint8_t& reg8(const Instance& instance, std::uint32_t offset) {
  return memory_at<volatile std::uint8_t>(instance.base + offset);
}

/// Changes one field and leaves the rest.
inline void modify(volatile std::uint32_t& word, const Field& field, std::uint32_t value) {
  word = (word & ~field.mask()) | field(value);
}

}  // namespace rosflight::boards::stm32h7
