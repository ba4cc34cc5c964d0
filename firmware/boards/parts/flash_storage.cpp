// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/flash_storage.hpp"

#include <algorithm>

#include "base/crc32.hpp"
#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::size_t kCrcBytes = 4, kBlockAt = 4, kGenerationAt = 6, kContentAt = 8;
constexpr hal::Time kWordLimit = hal::milliseconds(10);
constexpr std::size_t kErasedInARow = 8;  ///< Behind the last word of the log.
constexpr int kWordsToTry = 4;

std::uint32_t crc_of(const FlashMedium::Word& word) {
  base::Crc32 crc;
  crc.add(word.data() + kCrcBytes, word.size() - kCrcBytes);
  return crc.value();
}

bool is_erased(const FlashMedium::Word& word) {
  return std::all_of(word.begin(), word.end(), [](std::uint8_t b) { return b == 0xFF; });
}

}  // namespace

// ---- words

FlashStorage::Word FlashStorage::make(std::uint16_t block, std::uint16_t generation,
                                      const Block& content) {
  Word word{};
  put_le16(&word[kBlockAt], block);
  put_le16(&word[kGenerationAt], generation);
  std::copy(content.begin(), content.end(), word.begin() + kContentAt);
  put_le32(&word[0], crc_of(word));
  return word;
}

bool FlashStorage::parse(const Word& word, std::uint16_t& block, std::uint16_t& generation) {
  if (le32(&word[0]) != crc_of(word)) return false;
  block = static_cast<std::uint16_t>(le16(&word[kBlockAt]));
  generation = static_cast<std::uint16_t>(le16(&word[kGenerationAt]));
  return true;
}

bool FlashStorage::wait() {
  const hal::Time begun = clock_.now();
  while (medium_.busy()) {
    if (clock_.now() - begun >= kWordLimit) return false;
  }
  return true;
}

bool FlashStorage::program(std::size_t sector, std::size_t at, const Word& content) {
  Word found{};
  return medium_.program(sector, at, content) && wait() && !medium_.failed() &&
         medium_.read(sector, at, found) && found == content;
}

// ---- finding the sector in force

bool FlashStorage::generation_of(std::size_t sector, std::uint16_t& generation) {
  std::uint16_t block = 0;
  Word word{};
  for (std::size_t at = 0; at < kFirst; ++at) {
    const bool intact = medium_.read(sector, at, word) && parse(word, block, generation);
    if (intact && block == kMark) return true;
  }
  return false;
}

bool FlashStorage::erased(std::size_t sector) {
  Word word{};
  for (std::size_t at = 0; at < medium_.words_per_sector(); ++at) {
    if (!medium_.read(sector, at, word) || !is_erased(word)) return false;
  }
  return true;
}

void FlashStorage::mount() {
  std::array<std::uint16_t, 2> generation{};
  const bool first = generation_of(0, generation[0]);
  const bool second = generation_of(1, generation[1]);
  copying_ = false;
  active_ = kNone;
  erasing_ = kNone;
  generation_ = 0;
  place_.fill(0);
  if (first || second) {
    const auto ahead = static_cast<std::uint16_t>(generation[1] - generation[0]);
    const bool later = ahead != 0 && ahead < 0x8000u;
    active_ = second && (!first || later) ? 1 : 0;
    generation_ = generation[active_];
    scan(active_);
  }
  for (std::size_t sector = 0; sector < 2; ++sector) {
    erased_[sector] = sector != active_ && erased(sector);
  }
}

/// The log ends before the first erased word. A word whose programming was cut may look erased, so a
/// few more are looked at.
void FlashStorage::scan(std::size_t sector) {
  Word word{};
  damaged_ = 0;
  next_ = kFirst;
  place_.fill(0);
  const std::size_t end = medium_.words_per_sector();
  for (std::size_t at = 0; at < end && at < next_ + kErasedInARow; ++at) {
    const bool readable = medium_.read(sector, at, word);
    if (readable && is_erased(word)) continue;
    next_ = std::max(kFirst, at + 1);
    std::uint16_t block = 0;
    std::uint16_t generation = 0;
    const bool intact = readable && parse(word, block, generation) && generation == generation_;
    if (intact && block < kBlocks && at >= kFirst) {
      place_[block] = static_cast<std::uint16_t>(at);
    } else if (!intact || block != kMark) {
      ++damaged_;
    }
  }
}

// ---- reading and writing

bool FlashStorage::read_block(std::size_t block, Block& content) {
  if (place_[block] == 0) {
    content.fill(0xFF);
    return true;
  }
  std::uint16_t found = 0;
  std::uint16_t generation = 0;
  Word word{};
  if (!medium_.read(active_, place_[block], word) || !parse(word, found, generation)) return false;
  std::copy_n(word.begin() + kContentAt, content.size(), content.begin());
  return found == block;
}

bool FlashStorage::read(std::size_t offset, std::uint8_t* data, std::size_t count) {
  if (offset > size() || count > size() - offset || medium_.busy()) return false;
  Block content{};
  while (count > 0) {
    const std::size_t within = offset % kBlockBytes;
    const std::size_t n = std::min(kBlockBytes - within, count);
    if (!read_block(offset / kBlockBytes, content)) return false;
    std::copy_n(content.begin() + static_cast<std::ptrdiff_t>(within), n, data);
    data += n;
    offset += n;
    count -= n;
  }
  return true;
}

/// A block that cannot be read any more is written as if it had been blank.
bool FlashStorage::write(std::size_t offset, const std::uint8_t* data, std::size_t count) {
  if (offset > size() || count > size() - offset || medium_.busy()) return false;
  Block content{};
  while (count > 0) {
    const std::size_t block = offset / kBlockBytes;
    const std::size_t within = offset % kBlockBytes;
    const std::size_t n = std::min(kBlockBytes - within, count);
    const bool known = read_block(block, content);
    if (!known) content.fill(0xFF);
    const auto place = content.begin() + static_cast<std::ptrdiff_t>(within);
    const bool same = known && std::equal(data, data + n, place);
    std::copy_n(data, n, place);
    if (!same && !append(block, content)) return false;
    data += n;
    offset += n;
    count -= n;
  }
  return true;
}

bool FlashStorage::append(std::size_t block, const Block& content) {
  if (active_ == kNone && !begin_first_sector()) return false;
  for (int k = 0; k < kWordsToTry; ++k) {
    if (next_ == medium_.words_per_sector() && !finish_copy()) return false;
    const std::size_t at = next_++;
    const auto index = static_cast<std::uint16_t>(block);
    if (!program(active_, at, make(index, generation_, content))) continue;
    place_[block] = static_cast<std::uint16_t>(at);
    to_copy_[block] = true;
    return true;
  }
  return false;
}

bool FlashStorage::begin_first_sector() {
  const std::size_t sector = erased_[0] ? 0 : 1;
  if (!erased_[sector] || !put_marks(sector, 1)) return false;
  active_ = sector;
  generation_ = 1;
  next_ = kFirst;
  return true;
}

/// One of the two is enough.
bool FlashStorage::put_marks(std::size_t sector, std::uint16_t generation) {
  erased_[sector] = false;
  const Word mark = make(kMark, generation, Block{});
  const bool first = program(sector, 0, mark);
  const bool second = program(sector, 1, mark);
  return first || second;
}

// ---- copying and erasing

void FlashStorage::maintain() {
  if (medium_.busy()) return;
  if (erasing_ != kNone) {
    erased_[erasing_] = !medium_.failed() && erased(erasing_);
    erasing_ = kNone;
    return;
  }
  const std::size_t other = active_ == kNone ? (erased_[0] ? 1 : 0) : 1 - active_;
  if (copying_) {
    copy_one();
  } else if (active_ != kNone && erased_[other]) {
    if (next_ < medium_.words_per_sector() / 4 * 3) return;
    copying_ = true;
    copy_at_ = kFirst;
    to_copy_.set();
  } else if (!erased_[other] && (active_ != kNone || !erased_[1 - other]) && medium_.erase(other)) {
    erasing_ = other;
  }
}

/// Copies one block, or puts the sector in force when none is left.
void FlashStorage::copy_one() {
  const std::size_t target = 1 - active_;
  erased_[target] = false;
  Block content{};
  for (std::size_t block = 0; block < kBlocks; ++block) {
    if (!to_copy_[block]) continue;
    to_copy_[block] = false;
    if (place_[block] == 0 || !read_block(block, content)) continue;
    if (copy_at_ == medium_.words_per_sector()) {
      copying_ = false;  // more damaged words than the sector can bear; it is erased again
      return;
    }
    const auto generation = static_cast<std::uint16_t>(generation_ + 1);
    const Word word = make(static_cast<std::uint16_t>(block), generation, content);
    if (!program(target, copy_at_++, word)) to_copy_[block] = true;
    return;
  }
  copying_ = false;
  const auto generation = static_cast<std::uint16_t>(generation_ + 1);
  if (!put_marks(target, generation)) return;
  active_ = target;
  generation_ = generation;
  scan(target);
}

/// The sector is full: all at once, for at most 0.2 s.
bool FlashStorage::finish_copy() {
  if (!copying_ && !erased_[1 - active_]) return false;
  if (!copying_) {
    copying_ = true;
    copy_at_ = kFirst;
    to_copy_.set();
  }
  const std::size_t full = active_;
  while (copying_) copy_one();
  return active_ != full;
}

}  // namespace rosflight::boards::parts
