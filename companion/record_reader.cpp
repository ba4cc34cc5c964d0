// SPDX-License-Identifier: BSD-3-Clause
#include "companion/record_reader.hpp"

#include <algorithm>

namespace rosflight::companion {

void RecordReader::step() {
  if (state_ != State::kReading) return;
  const Time now = session_.now();
  if (known_ && !find_missing()) {
    state_ = State::kComplete;
  } else if (window_done_ || now >= again_) {
    request(now);
  }
}

/// Moves missing_ on. @returns false if nothing is missing.
bool RecordReader::find_missing() {
  missing_ = std::max(missing_, oldest_);
  while (missing_ <= newest_ && entries_.count(missing_) != 0) ++missing_;
  return missing_ <= newest_;
}

void RecordReader::request(Time now) {
  if (attempts_ == kAttempts) {
    state_ = known_ ? State::kStopped : State::kNoRecord;
    return;
  }
  ++attempts_;
  const std::uint32_t left = known_ ? newest_ - missing_ + 1 : 0;
  const auto count = static_cast<std::uint16_t>(std::min<std::uint32_t>(left, kWindow));
  window_end_ = missing_ + count - 1;
  window_done_ = false;
  again_ = now + kSilence;
  static_cast<void>(session_.request_record(missing_, count));
}

void RecordReader::on_received(const link::Message& message, const Stamp& /*stamp*/) {
  const auto* const half = std::get_if<link::RecordPart>(&message);
  if (half == nullptr || state_ != State::kReading || half->part > 1) return;
  if (!known_) newest_ = half->newest;
  window_done_ = !known_ || (half->number == window_end_ && half->part == 1);
  known_ = true;
  oldest_ = std::max(oldest_, half->oldest);
  attempts_ = 0;
  again_ = session_.now() + kSilence;
  if (half->part == 1 && half->number != arriving_number_) return;  // its first half was lost
  arriving_number_ = half->number;
  std::copy(half->bytes.begin(), half->bytes.end(),
            arriving_.begin() + half->part * static_cast<std::ptrdiff_t>(half->bytes.size()));
  if (half->part == 1 && half->number != 0) entries_[half->number] = arriving_;
}

}  // namespace rosflight::companion
