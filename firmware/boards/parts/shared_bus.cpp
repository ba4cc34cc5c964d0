// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/shared_bus.hpp"

#include <algorithm>

namespace rosflight::boards::parts {
namespace {

bool well_formed(const Transfer& transfer) {
  const std::size_t count = transfer.out_count + transfer.in_count;
  return transfer.owner != nullptr && count > 0 && transfer.out_count <= kMaxTransferBytes &&
         transfer.in_count <= kMaxTransferBytes && count <= kMaxTransferBytes &&
         (transfer.out_count == 0 || transfer.out != nullptr) &&
         (transfer.in_count == 0 || transfer.in != nullptr);
}

}  // namespace

bool SharedBus::submit(std::uint8_t device, bool urgent, Transfer& transfer) {
  if (!well_formed(transfer)) return false;
  const std::uint32_t masked = hardware_.mask();
  const bool room = count_ < kSlots;
  if (room) {
    waiting_[count_++] = {&transfer, device, urgent};
    if (active_ == nullptr) begin_next();
  }
  hardware_.unmask(masked);
  return room;
}

/// With interrupts masked.
void SharedBus::begin_next() {
  if (count_ == 0) return;
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(count_);
  auto next = std::find_if(waiting_.begin(), end, [](const Waiting& w) { return w.urgent; });
  if (next == end) next = waiting_.begin();
  const Waiting chosen = *next;
  std::copy(next + 1, end, next);
  --count_;
  active_ = chosen.transfer;
  begun_ = clock_.now();
  hardware_.begin(chosen.device, *chosen.transfer);
}

/// The owner comes first: what it starts now is urgent if it is one of a chain.
void SharedBus::finish(TransferResult result) {
  Transfer* const ended = active_;
  if (ended == nullptr) return;
  if (result != TransferResult::kDone) ++failures_;
  active_ = nullptr;
  ended->owner->transfer_done(*ended, result, clock_.now());
  const std::uint32_t masked = hardware_.mask();
  if (active_ == nullptr) begin_next();
  hardware_.unmask(masked);
}

void SharedBus::complete(TransferResult result) {
  finish(result);
}

void SharedBus::step() {
  const std::uint32_t masked = hardware_.mask();
  const bool late = active_ != nullptr && clock_.now() - begun_ >= limit_;
  if (late) hardware_.abort();
  hardware_.unmask(masked);
  if (late) finish(TransferResult::kTimeout);
}

}  // namespace rosflight::boards::parts
