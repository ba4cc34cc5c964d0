// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::boards::parts {

/// Two sectors of flash that are programmed by words and erased whole, for FlashStorage. The program
/// does not run from them, so it goes on while they are erased or programmed.
class FlashMedium {
 public:
  static constexpr std::size_t kWordBytes = 32;
  using Word = std::array<std::uint8_t, kWordBytes>;

  virtual std::size_t words_per_sector() const = 0;
  /// @returns false if the word cannot be corrected (its error flag is cleared, no fault remains), or
  /// while the medium is busy. An erased word reads 0xFF throughout.
  virtual bool read(std::size_t sector, std::size_t word, Word& content) = 0;
  /// Starts to program an erased word and returns. @returns false if busy or refused.
  virtual bool program(std::size_t sector, std::size_t word, const Word& content) = 0;
  /// Starts to erase a sector (0 or 1) and returns; 1..2 s. @returns false if busy or refused.
  virtual bool erase(std::size_t sector) = 0;
  virtual bool busy() = 0;
  /// The last program or erase reported an error; asked when no longer busy.
  virtual bool failed() = 0;

 protected:
  ~FlashMedium() = default;
};

}  // namespace rosflight::boards::parts
