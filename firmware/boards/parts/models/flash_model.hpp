// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <random>
#include <vector>

#include "firmware/boards/parts/flash_medium.hpp"
#include "firmware/hal/time.hpp"

namespace rosflight::boards::parts::models {

/// Two sectors of flash with an error-correcting code per word of 32 bytes. A word that was cut while
/// it was programmed or erased, and one that was programmed twice, cannot be read; so can any word that a
/// test damages. After a cut nothing works until the power returns.
class FlashModel final : public FlashMedium {
 public:
  /// @param now  the time, for how long an operation takes.
  FlashModel(std::size_t words, std::function<hal::Time()> now)
      : now_{std::move(now)}, sectors_{std::vector<Cell>(words), std::vector<Cell>(words)} {}

  std::size_t words_per_sector() const override { return sectors_[0].size(); }
  bool read(std::size_t sector, std::size_t word, Word& content) override;
  bool program(std::size_t sector, std::size_t word, const Word& content) override;
  bool erase(std::size_t sector) override;
  bool busy() override { return powered_ && now_() < busy_until_; }
  bool failed() override { return failed_; }

  /// The operation after the next `operations` is cut in its middle. @param erased_share  how much of a
  /// sector had been erased by then, 0..1.
  void cut_after(std::uint64_t operations, double erased_share = 0.5);
  void power_cycle();
  /// A reset or a loss of power, now: a word that is being programmed cannot be read afterwards; a sector that is being
  /// erased has lost what was erased so far, and words at that place cannot be read.
  void interrupt();
  bool powered() const { return powered_; }
  /// Makes a word unreadable.
  void damage(std::size_t sector, std::size_t word) { sectors_[sector][word].torn = true; }
  /// Makes a damaged word readable again.
  void repair(std::size_t sector, std::size_t word) { sectors_[sector][word].torn = false; }
  bool used(std::size_t sector, std::size_t word) const {
    return sectors_[sector][word].programmed;
  }
  /// Fills everything as a part that was used for something else.
  void fill_with_noise(std::uint32_t seed);

  hal::Time program_time{200};
  hal::Time erase_time{hal::milliseconds(1500)};
  bool fail_erase{false};       ///< Ends with an error, without an effect.
  int worn_words{0};            ///< So many of the next words do not hold what is programmed.
  std::uint64_t operations{0};  ///< Begun since construction.
  std::uint64_t twice{0};       ///< Words programmed without having been erased.
  std::uint64_t torn{0};        ///< Words that interrupt() made unreadable.

 private:
  struct Cell {
    Word content = blank();
    bool programmed{false};
    bool torn{false};
  };
  static Word blank() {
    Word word{};
    word.fill(0xFF);
    return word;
  }
  bool begin(hal::Time duration);
  /// Erases up to this share of a sector. @returns how many words behind it are torn.
  std::size_t erase_part(std::size_t sector, double share);

  std::function<hal::Time()> now_;
  std::array<std::vector<Cell>, 2> sectors_;
  hal::Time busy_until_{};
  /// The operation that runs while busy: of one word, or of a sector with what it held before.
  std::size_t sector_under_way_{0}, word_under_way_{0};
  std::vector<Cell> before_erase_;
  std::uint64_t cut_at_{UINT64_MAX};
  double erased_share_{0.5};
  bool powered_{true};
  bool failed_{false};
};

}  // namespace rosflight::boards::parts::models
