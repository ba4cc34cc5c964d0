// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/processor.hpp"

#include <unicorn/unicorn.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "firmware/boards/stm32h7/emulator/flash_control.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr std::uint32_t kFlashEnd = 0x20'0000U;      // of the addresses that blocks_ distinguishes
constexpr std::uint64_t kInstructionHalfCycles = 3;  // 1.5 cycles each

void check(uc_err error, const char* what) {
  if (error != UC_ERR_OK) throw ProcessorError(std::string(what) + ": " + uc_strerror(error));
}

}  // namespace

std::string at_address(const std::string& what, std::uint32_t address) {
  char text[16];
  std::snprintf(text, sizeof text, " 0x%08x", address);
  return what + text;
}

/// Unicorn calls these with the processor as the last argument.
struct Processor::Hooks {
  static Processor& of(void* self) { return *static_cast<Processor*>(self); }

  /// Called a hundred million times in a flight: what nearly every block needs, and no more.
  static void block(uc_engine* /*uc*/, std::uint64_t address, std::uint32_t size, void* self) {
    Processor& p = of(self);
    const auto at = static_cast<std::uint32_t>(address);
    const Block& known = p.block_at(at);
    if (known.half_words == size / 2 && !p.slow_ && p.now_ < p.next_due_ && p.now_ < p.target_) {
      p.charge(known.instructions);
    } else {
      p.begin_slowly(at, size);
    }
  }

  static void interrupt(uc_engine* /*uc*/, std::uint32_t number, void* self) {
    constexpr std::uint32_t kSvc = 2, kExceptionReturn = 8;
    Processor& p = of(self);
    // A handler that ends with `pop {pc}` leaves EXC_RETURN in the program counter too.
    if (number == kExceptionReturn) return p.leave(p.get(UC_ARM_REG_PC) | 1U);
    if (number == kSvc) return p.enter(kSvCall, p.get(UC_ARM_REG_PC));
    p.raise(kHardFault, "unexpected exception " + std::to_string(number), 0, 0);
  }

  static bool invalid(uc_engine* /*uc*/, void* self) {
    Processor& p = of(self);
    const std::uint32_t pc = p.get(UC_ARM_REG_PC);
    const std::uint8_t* const code = p.memory(pc - 2, 2);
    constexpr std::uint8_t kHint = 0xBF, kYield = 0x10, kWaitForEvent = 0x20;
    if (code != nullptr && code[1] == kHint && (code[0] == kYield || code[0] == kWaitForEvent)) {
      return true;
    }
    p.raise(kUsageFault, at_address("undefined instruction at", pc), 1U << 16U, 0);
    return true;
  }

  static bool bad_access(uc_engine* /*uc*/, uc_mem_type /*type*/, std::uint64_t address,
                         int /*size*/, std::int64_t /*value*/, void* self) {
    constexpr std::uint32_t kPreciseWithAddress = 0x8200U;
    const auto at = static_cast<std::uint32_t>(address);
    of(self).raise(kBusFault, at_address("bus fault at", at), kPreciseWithAddress, at);
    return false;
  }

  /// Read and write rights together, and no execution from RAM: else each store is four times slower.
  static bool fill(uc_engine* /*uc*/, std::uint64_t address, uc_mem_type type, uc_tlb_entry* entry,
                   void* self) {
    entry->paddr = address;
    std::uint32_t rights = UC_PROT_READ | UC_PROT_WRITE;
    for (const Memory& m : of(self).memories_) {
      if (address >= m.base && address < m.base + m.size && m.kind != Kind::kRam) {
        rights |= UC_PROT_EXEC;
      }
    }
    const auto [read, write] = of(self).control_.rights(static_cast<std::uint32_t>(address));
    if (!read) rights = 0;
    if (!write) rights &= ~static_cast<std::uint32_t>(UC_PROT_WRITE);
    const bool forbidden = (type == UC_MEM_READ && !read) || (type == UC_MEM_WRITE && !write);
    if (forbidden) of(self).forbidden_ = static_cast<std::uint32_t>(address);
    // NOLINTNEXTLINE(clang-analyzer-optin.core.EnumCastOutOfRange): bits of the enumeration
    entry->perms = static_cast<uc_prot>(rights);
    return true;
  }

  template <std::uint32_t kBase>
  static std::uint64_t read(uc_engine* /*uc*/, std::uint64_t offset, unsigned size, void* self) {
    return of(self).bus_read(kBase + static_cast<std::uint32_t>(offset), size);
  }
  template <std::uint32_t kBase>
  static void write(uc_engine* /*uc*/, std::uint64_t offset, unsigned size, std::uint64_t value,
                    void* self) {
    of(self).bus_write(kBase + static_cast<std::uint32_t>(offset),
                       static_cast<std::uint32_t>(value), size);
  }

  template <std::uint32_t kBase>
  static void map(Processor& p, std::uint32_t size) {
    check(uc_mmio_map(p.uc_, kBase, size, read<kBase>, &p, write<kBase>, &p), "registers");
  }
};

Processor::Processor()
    : control_{nvic_, [this](const std::string& what) { complain(what); }}, blocks_(kFlashEnd / 2) {
  // Not UC_MODE_MCLASS: that makes a Cortex-M33 of it, whatever model is asked for.
  check(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &uc_), "unicorn");
  check(uc_ctl_set_cpu_model(uc_, UC_CPU_ARM_CORTEX_M7), "Cortex-M7");
  check(uc_ctl_tlb_mode(uc_, UC_TLB_VIRTUAL), "TLB");
  // None: Unicorn would translate the block at such an address again at each start.
  check(uc_ctl_exits_enable(uc_), "exits");
  uc_hook hook = 0;
  const auto add = [this, &hook](int type, auto* function) {
    check(uc_hook_add(uc_, &hook, type, reinterpret_cast<void*>(function), this, 1, 0), "hook");
  };
  add(UC_HOOK_TLB_FILL, Hooks::fill);
  add(UC_HOOK_BLOCK, Hooks::block);
  add(UC_HOOK_INTR, Hooks::interrupt);
  add(UC_HOOK_INSN_INVALID, Hooks::invalid);
}

Processor::~Processor() {
  uc_close(uc_);
}

void Processor::add_memory(std::uint32_t base, std::size_t size, Kind kind) {
  constexpr std::size_t kPage = 4096;
  auto* const bytes = static_cast<std::uint8_t*>(std::aligned_alloc(kPage, size));
  if (bytes == nullptr) throw ProcessorError("no memory for the emulated chip");
  memories_.push_back({base, size, kind, {bytes, std::free}});
  std::memset(bytes, kind == Kind::kRam ? 0 : 0xFF, size);
  std::uint32_t rights = UC_PROT_READ;
  if (kind != Kind::kFlash) rights |= UC_PROT_WRITE;
  if (kind != Kind::kRam) rights |= UC_PROT_EXEC;
  check(uc_mem_map_ptr(uc_, base, size, rights, bytes), "memory");
}

void Processor::add(Peripheral& peripheral) {
  windows_.push_back({peripheral.instance().base, peripheral.size(), &peripheral});
  timed_.push_back(&peripheral);
}

void Processor::finish() {
  timed_.push_back(&sys_tick_);
  const auto by_base = [](const auto& a, const auto& b) { return a.base < b.base; };
  std::sort(windows_.begin(), windows_.end(), by_base);
  Hooks::map<FlashSectorsWindow::kBase>(*this, 2 * FlashControl::kSectorBytes);
  Hooks::map<0x4000'0000U>(*this, 0x0810'0000U);
  Hooks::map<0x5000'0000U>(*this, 0x0010'0000U);
  Hooks::map<0x5100'0000U>(*this, 0x0200'0000U);
  Hooks::map<0x5800'0000U>(*this, 0x0010'0000U);
  Hooks::map<0x5C00'0000U>(*this, 0x0010'0000U);
  Hooks::map<SystemControl::kBase>(*this, SystemControl::kSize);
  // Not over RAM: where this hook lies, every store takes the slow path.
  std::sort(memories_.begin(), memories_.end(), by_base);
  newest_memory_ = nullptr;
  std::uint64_t from = 0;
  uc_hook hook = 0;
  const auto watch = [this, &hook](std::uint64_t first, std::uint64_t last) {
    check(uc_hook_add(uc_, &hook, UC_HOOK_MEM_UNMAPPED | UC_HOOK_MEM_PROT,
                      reinterpret_cast<void*>(Hooks::bad_access), this, first, last),
          "hook");
  };
  for (const Memory& m : memories_) {
    if (m.kind == Kind::kFlash) continue;
    if (m.base > from) watch(from, m.base - 1);
    from = m.base + m.size;
  }
  watch(from, 0xFFFF'FFFFU);
}

std::uint8_t* Processor::memory(std::uint32_t address, std::size_t count) {
  const auto holds = [address, count](const Memory& m) {
    return address >= m.base && address - m.base + count <= m.size;
  };
  if (newest_memory_ == nullptr || !holds(*newest_memory_)) {
    const auto found = std::find_if(memories_.begin(), memories_.end(), holds);
    if (found == memories_.end()) return nullptr;
    newest_memory_ = &*found;
  }
  return newest_memory_->bytes.get() + (address - newest_memory_->base);
}

// ---- time

void Processor::set_frequency(std::uint64_t core_Hz) {
  const std::uint64_t half_cycle = kTicksPerSecond / 2;
  sys_tick_.set_cycle((2 * half_cycle + core_Hz / 2) / core_Hz);
  instruction_ticks_ = (kInstructionHalfCycles * half_cycle + core_Hz / 2) / core_Hz;
}

inline void Processor::charge(unsigned instructions) {
  now_ += instructions * instruction_ticks_;
  counters_.instructions += instructions;
}

inline Processor::Block& Processor::block_at(std::uint32_t address) {
  return blocks_[(address & (kFlashEnd - 1)) / 2];
}

/// Instructions of a block of flash; counted once and kept, if it is not a very long one.
unsigned Processor::count(std::uint32_t address, std::uint32_t size) {
  Block& block = block_at(address);
  if (block.half_words == size / 2) return block.instructions;
  const unsigned instructions = count_again(address, size);
  constexpr unsigned kMost = std::numeric_limits<std::uint8_t>::max();
  if (size / 2 <= kMost)
    block = {static_cast<std::uint8_t>(size / 2), static_cast<std::uint8_t>(instructions)};
  return instructions;
}

unsigned Processor::count_again(std::uint32_t address, std::uint32_t size) {
  constexpr unsigned kFirstWide = 0xE800U;  // half words from here on begin 32-bit instructions
  const std::uint8_t* const code = memory(address, size);
  unsigned instructions = 0;
  for (std::uint32_t k = 0; code != nullptr && k + 1 < size; ++instructions) {
    k += (unsigned{code[k]} | unsigned{code[k + 1]} << 8U) >= kFirstWide ? 4 : 2;
  }
  return instructions;
}

void Processor::set_due(Timed& timed, Ticks time) {
  timed.due = time;
  next_due_ = std::min(next_due_, time);
}

void Processor::run_events() {
  constexpr int kTooMany = 100'000;
  for (int round = 0; next_due_ <= now_; ++round) {
    if (round == kTooMany) throw ProcessorError("a model asks for events without end");
    next_due_ = kNever;  // events may bring it forward while they run
    for (Timed* const each : timed_) {
      if (each->due <= now_) {
        each->due = kNever;
        each->event(now_);
      }
      next_due_ = std::min(next_due_, each->due);
    }
  }
}

/// At the beginning of a block: what is due, then interrupts, then the caller's time.
void Processor::begin_slowly(std::uint32_t address, std::uint32_t size) {
  const unsigned instructions = count(address, size);
  if (now_ >= next_due_) run_events();
  if (reset_requested_ || fault_ != 0 || now_ >= target_) {
    resume_at_ = address;
    return stop();
  }
  if (nvic_.any_pending()) {
    if (const int exception = nvic_.next(masks()); exception != 0) return enter(exception, address);
  }
  slow_ = nvic_.any_pending();  // masked now; look again at the next block
  charge(instructions);
}

void Processor::stop() {
  stopped_ = true;
  uc_emu_stop(uc_);
}

void Processor::sleep() {
  while (!nvic_.any_pending() && !reset_requested_ && now_ < target_) {
    const Ticks wake = std::min(next_due_, target_);
    if (wake > now_) {
      counters_.slept += wake - now_;
      now_ = wake;
    }
    if (now_ >= next_due_) run_events();
  }
}

void Processor::run_until(Ticks time) {
  target_ = time;
  while (now_ < target_) {
    if (locked_up_ && !reset_requested_) {  // only a reset ends this; the watchdog may bring one
      now_ = std::min(next_due_, target_);
      if (now_ >= next_due_) run_events();
      continue;
    }
    if (reset_requested_) reset_now();
    stopped_ = false;
    slow_ = nvic_.any_pending() || fault_ != 0;
    const uc_err error = uc_emu_start(uc_, resume_at_ | 1U, 0, 0, 0);
    if (forbidden_) {
      constexpr std::uint32_t kDataAccess = 0x82U;  // with its address
      const std::uint32_t at = *forbidden_;
      forbidden_.reset();
      raise(kMemoryFault, at_address("the MPU forbids an access to", at), kDataAccess, at);
    }
    if (fault_ != 0) {
      take_fault();
    } else if (!stopped_ && !reset_requested_) {
      resume_at_ = get(UC_ARM_REG_PC);  // it stands behind a WFI
      if (error != UC_ERR_OK) check(error, at_address("instruction at", resume_at_).c_str());
      sleep();
    }
  }
}

// ---- reset

void Processor::request_reset() {
  reset_requested_ = true;
  slow_ = true;
}

void Processor::reset_now() {
  ++counters_.resets;
  power_on(vector_table_);
}

void Processor::power_on(std::uint32_t vector_table) {
  vector_table_ = vector_table;
  nvic_.reset();
  control_.reset(vector_table);
  sys_tick_.reset();
  reset_requested_ = locked_up_ = stopped_ = false;
  fault_ = 0;
  cleared_ = nullptr;
  next_due_ = kNever;
  for (const Window& w : windows_) {
    w.peripheral->due = kNever;
    w.peripheral->reset();
  }
  for (const Timed* const each : timed_) next_due_ = std::min(next_due_, each->due);
  for (const int id : {UC_ARM_REG_IPSR, UC_ARM_REG_CONTROL, UC_ARM_REG_PRIMASK, UC_ARM_REG_BASEPRI,
                       UC_ARM_REG_FAULTMASK, UC_ARM_REG_APSR_NZCV}) {
    set(id, 0);
  }
  const std::uint8_t* const table = memory(vector_table, 8);
  if (table == nullptr)
    throw ProcessorError(at_address("no memory for a vector table at", vector_table));
  std::uint32_t stack = 0;
  std::memcpy(&stack, table, 4);
  std::memcpy(&resume_at_, table + 4, 4);
  set(UC_ARM_REG_SP, stack);
  set(UC_ARM_REG_LR, 0xFFFF'FFFFU);
  // NOLINTNEXTLINE(clang-analyzer-optin.core.EnumCastOutOfRange): in a macro of Unicorn
  uc_ctl_remove_cache(uc_, vector_table,
                      vector_table + kFlashEnd - (vector_table & (kFlashEnd - 1)));
  if ((resume_at_ & 1U) == 0 || memory(resume_at_ & ~1U, 2) == nullptr ||
      memory(stack - 4, 4) == nullptr) {
    throw ProcessorError(at_address("no vector table at", vector_table));
  }
}

// ---- what models ask for

void Processor::set_line(unsigned irq, bool high) {
  nvic_.set_line(irq, high);
  if (nvic_.any_pending()) slow_ = true;
}

void Processor::complain(const std::string& what) {
  if (!on_complaint) return;
  const std::string when = "[" + std::to_string(now_ / kTicksPerMicrosecond) + " us] ";
  on_complaint(at_address(when + what + "; pc", get(UC_ARM_REG_PC)));
}

}  // namespace rosflight::boards::stm32h7::emulator
