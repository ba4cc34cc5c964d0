// SPDX-License-Identifier: BSD-3-Clause
// Entry and return of exceptions, and faults: Armv7-M ARM (DDI 0403E) B1.5.6 to B1.5.8.
#include <unicorn/unicorn.h>

#include <cstring>

#include "firmware/boards/stm32h7/emulator/processor.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kBasicFrame = 0x20, kFloatFrame = 0x68;
constexpr std::uint32_t kFloatActive = 4;     // CONTROL.FPCA
constexpr std::uint32_t kAligned = 1U << 9U;  // of the stacked PSR: four bytes were skipped
constexpr std::uint32_t kThumb = 1U << 24U;
constexpr std::uint32_t kIfThen = 0x0600'FC00U;  // what is left of an IT block
constexpr Ticks kEntryTicks = Ticks{12} * 2,
                kReturnTicks = Ticks{10} * 2;  // cycles of the Cortex-M7 TRM

constexpr int kCore[8] = {UC_ARM_REG_R0,  UC_ARM_REG_R1, UC_ARM_REG_R2,   UC_ARM_REG_R3,
                          UC_ARM_REG_R12, UC_ARM_REG_LR, UC_ARM_REG_XPSR, UC_ARM_REG_SP};

/// S0 to S15 and FPSCR, as they lie in a frame.
struct FloatRegisters {
  std::uint64_t d[8]{};
  std::uint32_t fpscr{};

  template <class Function>
  void each(Function&& transfer) {
    int ids[9];
    void* at[9];
    for (int k = 0; k < 8; ++k) {
      ids[k] = UC_ARM_REG_D0 + k;
      at[k] = &d[k];
    }
    ids[8] = UC_ARM_REG_FPSCR;
    at[8] = &fpscr;
    transfer(ids, at);
  }
};

}  // namespace

std::uint32_t Processor::get(int id) const {
  std::uint32_t value = 0;
  uc_reg_read(uc_, id, &value);
  return value;
}

void Processor::set(int id, std::uint32_t value) const {
  uc_reg_write(uc_, id, &value);
}

Nvic::Masks Processor::masks() const {
  return {(get(UC_ARM_REG_PRIMASK) & 1U) != 0, (get(UC_ARM_REG_FAULTMASK) & 1U) != 0,
          static_cast<std::uint8_t>(get(UC_ARM_REG_BASEPRI))};
}

void Processor::enter(int exception, std::uint32_t return_address) {
  ++counters_.exceptions;
  const std::uint32_t control = get(UC_ARM_REG_CONTROL);
  const bool floats = (control & kFloatActive) != 0;
  std::uint32_t value[8];
  void* at[8];
  for (int k = 0; k < 8; ++k) at[k] = &value[k];
  uc_reg_read_batch(uc_, const_cast<int*>(kCore), at, 8);

  std::uint32_t sp = value[7] - (floats ? kFloatFrame : kBasicFrame);
  std::uint32_t psr = (value[6] | kThumb) & ~kAligned;
  if ((sp & 4U) != 0) {
    sp -= 4;
    psr |= kAligned;
  }
  if (std::uint8_t* const frame = memory(sp, floats ? kFloatFrame : kBasicFrame)) {
    const std::uint32_t words[8] = {
        value[0], value[1], value[2], value[3], value[4], value[5], return_address & ~1U, psr};
    std::memcpy(frame, words, sizeof words);
    if (floats) {
      FloatRegisters f;
      f.each([this](int* ids, void** to) { uc_reg_read_batch(uc_, ids, to, 9); });
      std::memcpy(frame + kBasicFrame, f.d, sizeof f.d);
      std::memcpy(frame + kBasicFrame + sizeof f.d, &f.fpscr, 4);
      set(UC_ARM_REG_CONTROL, control & ~kFloatActive);
    }
  } else {
    // The stack has left the memory: no frame is written, and the hard fault handler runs.
    control_.note_fault(1U << 12U, 1U << 30U, 0);
    if (on_fault) on_fault("exception entry with the stack outside of memory");
    if (exception == kHardFault) {
      locked_up_ = true;
      return stop();
    }
    nvic_.pend(kHardFault);
    exception = kHardFault;
  }
  nvic_.activate(exception);
  slow_ = nvic_.any_pending();
  set(UC_ARM_REG_SP, sp);
  constexpr std::uint32_t kToHandler = 0xFFFF'FFF1U, kToThread = 0xFFFF'FFF9U, kNoFloats = 0x10U;
  set(UC_ARM_REG_LR, (nvic_.nested() ? kToHandler : kToThread) & (floats ? ~kNoFloats : ~0U));
  set(UC_ARM_REG_XPSR_NZCVQG,
      psr & ~(kIfThen | kAligned));  // a block ends within one at a page's end
  set(UC_ARM_REG_IPSR, static_cast<std::uint32_t>(exception));
  set(UC_ARM_REG_APSR_NZCV, psr);  // Unicorn renews its flags of translation with this
  std::uint32_t handler = 0;
  if (const auto* entry =
          memory(control_.vector_table() + 4U * static_cast<std::uint32_t>(exception), 4)) {
    std::memcpy(&handler, entry, 4);
  }
  set(UC_ARM_REG_PC, handler);
  now_ += kEntryTicks;
}

void Processor::leave(std::uint32_t exc_return) {
  const bool floats = (exc_return & 0x10U) == 0;
  std::uint32_t sp = get(UC_ARM_REG_SP);
  const std::uint32_t size = floats ? kFloatFrame : kBasicFrame;
  const std::uint8_t* const frame = memory(sp, size);
  check_return();
  const int exception = frame != nullptr ? nvic_.deactivate() : 0;
  if (exception == 0) return raise(kHardFault, "exception return without a frame", 1U << 11U, 0);
  std::uint32_t words[8];
  std::memcpy(words, frame, sizeof words);
  if (exception != kNmi) set(UC_ARM_REG_FAULTMASK, 0);
  if (floats) {
    FloatRegisters f;
    std::memcpy(f.d, frame + kBasicFrame, sizeof f.d);
    std::memcpy(&f.fpscr, frame + kBasicFrame + sizeof f.d, 4);
    f.each([this](int* ids, void** from) { uc_reg_write_batch(uc_, ids, from, 9); });
  }
  sp += size + ((words[7] & kAligned) != 0 ? 4 : 0);
  set(UC_ARM_REG_IPSR, words[7] & 0x1FFU);
  set(UC_ARM_REG_SP, sp);
  const std::uint32_t control = get(UC_ARM_REG_CONTROL);
  set(UC_ARM_REG_CONTROL, floats ? control | kFloatActive : control & ~kFloatActive);
  void* at[6];
  for (int k = 0; k < 6; ++k) at[k] = &words[k];
  uc_reg_write_batch(uc_, const_cast<int*>(kCore), at, 6);
  set(UC_ARM_REG_XPSR_NZCVQG, words[7] & ~kAligned);
  set(UC_ARM_REG_APSR_NZCV, words[7]);
  set(UC_ARM_REG_PC, words[6] | 1U);
  slow_ = nvic_.any_pending();
  now_ += kReturnTicks;
}

/// Faults are taken outside of the translation that met them: run_until() does it.
void Processor::raise(int exception, const std::string& what, std::uint32_t status,
                      std::uint32_t address) {
  if (on_fault) on_fault(what);
  constexpr std::uint32_t kForced = 1U << 30U;
  const bool escalates = exception != kHardFault && !control_.fault_enabled(exception);
  control_.note_fault(status, escalates ? kForced : 0, address);
  fault_ = escalates ? kHardFault : exception;
  resume_at_ = get(UC_ARM_REG_PC);
  stop();
}

/// Code of priority -1 that asked for it goes on as if nothing had happened: B1.5.8.
void Processor::bus_error() {
  if (masks().faultmask && control_.ignores_bus_faults()) return;
  constexpr std::uint32_t kImprecise = 1U << 10U;
  if (on_fault) on_fault("bus error, imprecise");
  control_.note_fault(kImprecise, control_.fault_enabled(kBusFault) ? 0 : 1U << 30U, 0);
  fault_ = control_.fault_enabled(kBusFault) ? kBusFault : kHardFault;
  slow_ = true;  // the next block begins with it
}

void Processor::take_fault() {
  const int fault = fault_;
  fault_ = 0;
  if (nvic_.active(kHardFault) || nvic_.active(kNmi)) {
    locked_up_ = true;
    return;
  }
  nvic_.pend(fault);
  const bool blocked = nvic_.next(masks()) != fault;
  if (blocked && fault != kHardFault) {
    nvic_.unpend(fault);
    nvic_.pend(kHardFault);
  }
  enter(blocked ? kHardFault : fault, resume_at_);
  resume_at_ = get(UC_ARM_REG_PC);
}

}  // namespace rosflight::boards::stm32h7::emulator
