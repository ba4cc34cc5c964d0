// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <bitset>

#include "firmware/boards/parts/flash_medium.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// hal::Storage of 16 416 bytes in two sectors of flash, as a log of words that each hold one block:
///
///     CRC-32 of the rest u32 | block u16 | generation u16 | 24 bytes of content
///
/// A write appends the blocks that it changes to the sector in force. When that is three quarters full,
/// maintain() copies the newest version of each block to the other sector, erased beforehand, and at
/// last writes its two marks (words with block kMark in places 0 and 1); only then is it in force. So a
/// cut of power at any word leaves every block old or new: the word that was cut fails its CRC, or cannot
/// be read at all, and the version before it stands. With one word damaged, marks included, the rest is
/// found.
///
/// Writing a block takes about 0.2 ms. The sector out of force is erased by maintain(), for 1 to 2 s in
/// which reads and writes are refused instead of waiting. An unchanged block costs nothing.
///
/// Owns 1.5 kB, no heap. All of it belongs to the main loop.
class FlashStorage final : public hal::Storage {
 public:
  static constexpr std::size_t kBlockBytes = 24;
  static constexpr std::size_t kBlocks = 684;  ///< Even, so no block lies in both halves.

  /// Both must outlive this. @param clock  limits the time of one word.
  FlashStorage(FlashMedium& medium, const hal::Clock& clock) : medium_{medium}, clock_{clock} {}

  /// Finds the sector in force. Once at the start, before anything else; a few ms.
  void mount();
  /// Copies and erases, one word or one start per call, without waiting. Call it in each pass while
  /// disarmed, and not while armed.
  void maintain();

  std::size_t size() const override { return kBlocks * kBlockBytes; }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override;
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override;
  bool flush() override { return wait(); }

  /// Words that could not be read or had a wrong CRC when the sector in force was searched.
  std::size_t damaged_words() const { return damaged_; }
  bool busy() { return medium_.busy(); }

 private:
  using Word = FlashMedium::Word;
  using Block = std::array<std::uint8_t, kBlockBytes>;
  static constexpr std::uint16_t kMark = 0xFFFE;
  static constexpr std::size_t kFirst = 2;  ///< Behind the marks.
  static constexpr std::size_t kNone = 2;   ///< No sector.

  static Word make(std::uint16_t block, std::uint16_t generation, const Block& content);
  static bool parse(const Word& word, std::uint16_t& block, std::uint16_t& generation);
  bool generation_of(std::size_t sector, std::uint16_t& generation);
  void scan(std::size_t sector);
  bool erased(std::size_t sector);
  bool wait();
  bool read_block(std::size_t block, Block& content);
  bool append(std::size_t block, const Block& content);
  bool program(std::size_t sector, std::size_t word, const Word& content);
  bool begin_first_sector();
  bool put_marks(std::size_t sector, std::uint16_t generation);
  void copy_one();
  bool finish_copy();

  FlashMedium& medium_;
  const hal::Clock& clock_;
  std::array<std::uint16_t, kBlocks>
      place_{};  ///< Word of each block's newest version; 0: never written.
  std::bitset<kBlocks> to_copy_;
  std::array<bool, 2> erased_{};
  std::size_t active_{kNone};
  std::size_t erasing_{kNone};
  std::uint16_t generation_{0};
  std::size_t next_{kFirst};  ///< Where the next block is appended.
  std::size_t copy_at_{kFirst};
  bool copying_{false};
  std::size_t damaged_{0};
};

}  // namespace rosflight::boards::parts
