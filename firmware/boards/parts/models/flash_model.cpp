// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/models/flash_model.hpp"

#include <utility>

namespace rosflight::boards::parts::models {

bool FlashModel::read(std::size_t sector, std::size_t word, Word& content) {
  if (!powered_ || busy()) return false;
  const Cell& cell = sectors_[sector][word];
  content = cell.content;
  return !cell.torn;
}

bool FlashModel::begin(hal::Time duration) {
  if (!powered_ || busy()) return false;
  failed_ = false;
  busy_until_ = now_() + duration;
  if (operations++ == cut_at_) powered_ = false;
  return true;
}

bool FlashModel::program(std::size_t sector, std::size_t word, const Word& content) {
  if (!begin(program_time)) return false;
  sector_under_way_ = sector;
  word_under_way_ = word;
  before_erase_.clear();
  Cell& cell = sectors_[sector][word];
  if (cell.programmed) ++twice;
  cell.torn = cell.torn || cell.programmed || !powered_;
  cell.programmed = true;
  cell.content = content;
  if (worn_words > 0) {
    --worn_words;
    cell.content[9] = static_cast<std::uint8_t>(cell.content[9] ^ 1u);
  }
  return true;
}

bool FlashModel::erase(std::size_t sector) {
  if (!begin(erase_time)) return false;
  if (fail_erase) {
    failed_ = true;
    return true;
  }
  sector_under_way_ = sector;
  before_erase_ = sectors_[sector];
  erase_part(sector, powered_ ? 1.0 : erased_share_);
  return true;
}

std::size_t FlashModel::erase_part(std::size_t sector, double share) {
  constexpr double kTornShare = 0.3;
  std::size_t torn_words = 0;
  auto& cells = sectors_[sector];
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const double at = static_cast<double>(k) / static_cast<double>(cells.size());
    if (at < share) {
      cells[k] = {};
    } else if (at < share + kTornShare) {
      cells[k].torn = true;
      ++torn_words;
    }
  }
  return torn_words;
}

void FlashModel::interrupt() {
  if (!busy()) return;
  if (before_erase_.empty()) {
    sectors_[sector_under_way_][word_under_way_].torn = true;
    ++torn;
  } else {
    const auto left = static_cast<double>((busy_until_ - now_()).count());
    sectors_[sector_under_way_] = std::exchange(before_erase_, {});
    torn += erase_part(sector_under_way_, 1.0 - left / static_cast<double>(erase_time.count()));
  }
  busy_until_ = hal::Time{};
}

void FlashModel::cut_after(std::uint64_t count, double erased_share) {
  cut_at_ = operations + count;
  erased_share_ = erased_share;
}

void FlashModel::power_cycle() {
  powered_ = true;
  cut_at_ = UINT64_MAX;
  busy_until_ = hal::Time{};
  failed_ = false;
}

void FlashModel::fill_with_noise(std::uint32_t seed) {
  std::mt19937 random(seed);
  for (auto& sector : sectors_) {
    for (Cell& cell : sector) {
      cell.programmed = true;
      for (std::uint8_t& byte : cell.content) byte = static_cast<std::uint8_t>(random());
    }
  }
}

}  // namespace rosflight::boards::parts::models
