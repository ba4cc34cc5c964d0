// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/nvic.hpp"

#include <algorithm>

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr int kBelowAll = 256;

}  // namespace

void Nvic::set_line(unsigned irq, bool high) {
  if (line_[irq] == high) return;
  line_[irq] = high;
  const int exception = kFirstIrq + static_cast<int>(irq);
  if (high && !active(exception)) pend(exception);
}

void Nvic::enable(unsigned irq, bool on) {
  enabled_[irq] = on;
  note_ready(kFirstIrq + static_cast<int>(irq));
}

void Nvic::pend(int exception) {
  pending_[index(exception)] = true;
  note_ready(exception);
}

void Nvic::unpend(int exception) {
  pending_[index(exception)] =
      exception >= kFirstIrq && line_[index(exception - kFirstIrq)] && !active(exception);
  note_ready(exception);
}

void Nvic::set_priority(int exception, std::uint8_t priority) {
  priority_[index(exception)] = priority & 0xF0U;
}

void Nvic::note_ready(int exception) {
  ready_[index(exception)] = pending_[index(exception)] &&
                             (exception < kFirstIrq || enabled_[index(exception - kFirstIrq)]);
}

int Nvic::priority(int exception) const {
  if (exception == kNmi) return -2;
  if (exception == kHardFault) return -1;
  return priority_[index(exception)] >> 4;
}

int Nvic::running_priority(const Masks& masks) const {
  int lowest = kBelowAll;
  // PRIGROUP counts from bit 0 of the byte; four bits are implemented.
  const unsigned sub_bits = group_ > 3 ? group_ - 3 : 0;
  for (const int e : stack_) {
    const int p = priority(e);
    lowest = std::min(lowest, p < 0 ? p : p >> sub_bits << sub_bits);
  }
  if (masks.basepri != 0) lowest = std::min(lowest, masks.basepri >> 4);
  if (masks.primask) lowest = std::min(lowest, 0);
  if (masks.faultmask) lowest = std::min(lowest, -1);
  return lowest;
}

int Nvic::next(const Masks& masks) const {
  int best = 0;
  int best_priority = kBelowAll;
  for (std::size_t at = ready_._Find_first(); at < kExceptions; at = ready_._Find_next(at)) {
    const int e = static_cast<int>(at);
    if (priority(e) >= best_priority) continue;
    best = e;
    best_priority = priority(e);
  }
  return best != 0 && best_priority < running_priority(masks) ? best : 0;
}

void Nvic::activate(int exception) {
  pending_[index(exception)] = false;
  active_[index(exception)] = true;
  stack_.push_back(exception);
  note_ready(exception);
}

int Nvic::deactivate() {
  if (stack_.empty()) return 0;
  const int exception = stack_.back();
  stack_.pop_back();
  active_[index(exception)] = false;
  if (exception >= kFirstIrq && line_[index(exception - kFirstIrq)]) pend(exception);
  return exception;
}

}  // namespace rosflight::boards::stm32h7::emulator
