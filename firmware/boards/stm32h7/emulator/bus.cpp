// SPDX-License-Identifier: BSD-3-Clause
// Accesses of the processor to registers: its own, and those of peripherals behind clock gates.
#include <unicorn/unicorn.h>

#include <algorithm>
#include <iterator>

#include "firmware/boards/stm32h7/emulator/processor.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kSystemControlSpace = 0xE000'E000U;

bool is_sys_tick(std::uint32_t address) {
  return address >= kSystemControlSpace + SysTick::kControl &&
         address < kSystemControlSpace + SysTick::kEnd;
}

}  // namespace

Processor::Window* Processor::window_at(std::uint32_t address) {
  const auto holds = [address](const Window& w) { return address - w.base < w.size; };
  if (newest_window_ != nullptr && holds(*newest_window_)) return newest_window_;
  const auto after = std::upper_bound(windows_.begin(), windows_.end(), address,
                                      [](std::uint32_t a, const Window& w) { return a < w.base; });
  if (after == windows_.begin()) return nullptr;
  Window& window = *std::prev(after);
  return holds(window) ? newest_window_ = &window : nullptr;
}

std::uint32_t Processor::bus_read(std::uint32_t address, unsigned size) {
  ++counters_.accesses;
  if (address >= SystemControl::kBase) {
    if (is_sys_tick(address)) return sys_tick_.read(address - kSystemControlSpace);
    return control_.read(address - SystemControl::kBase, now_);
  }
  const Window* const window = window_at(address);
  if (window == nullptr) {
    complain(at_address("no peripheral at", address));
    return 0;
  }
  if (gate_is_open_ && !gate_is_open_(window->peripheral->instance())) {
    complain(window->peripheral->name() + ": read while its clock gate is closed");
    return 0;
  }
  if (window->peripheral == cleared_) cleared_ = nullptr;
  return window->peripheral->bus_read(address - window->base, size);
}

void Processor::bus_write(std::uint32_t address, std::uint32_t value, unsigned size) {
  ++counters_.accesses;
  if (is_sys_tick(address)) return sys_tick_.write(address - kSystemControlSpace, value);
  if (address >= SystemControl::kBase) {
    control_.write(address - SystemControl::kBase, value, size, now_);
    if (nvic_.any_pending()) slow_ = true;
    // NOLINTNEXTLINE(clang-analyzer-optin.core.EnumCastOutOfRange): in a macro of Unicorn
    if (control_.take_mpu_change()) uc_ctl_flush_tlb(uc_);
    if (control_.take_reset_request()) {
      if (on_reset) on_reset(true);
      request_reset();
    }
    return;
  }
  const Window* const window = window_at(address);
  if (window == nullptr) return complain(at_address("no peripheral at", address));
  if (gate_is_open_ && !gate_is_open_(window->peripheral->instance())) {
    return complain(window->peripheral->name() + ": written while its clock gate is closed");
  }
  const bool asked = asks_again();
  window->peripheral->bus_write(address - window->base, value, size);
  if (!asked || asks_again()) return;
  cleared_ = window->peripheral;
  cleared_by_ = nvic_.running();
}

/// Whether the line of the running handler is high.
bool Processor::asks_again() const {
  const int running = nvic_.running();
  return running >= kFirstIrq && nvic_.line(static_cast<unsigned>(running - kFirstIrq));
}

/// A write to a peripheral takes longer than the return from a handler, which would run twice.
void Processor::check_return() {
  if (cleared_ == nullptr || cleared_by_ != nvic_.running()) return;
  complain(cleared_->name() + ": its handler ends without reading back what cleared the request");
  cleared_ = nullptr;
}

}  // namespace rosflight::boards::stm32h7::emulator
