// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/boards/stm32h7/emulator/core.hpp"
#include "firmware/boards/stm32h7/emulator/nvic.hpp"
#include "firmware/boards/stm32h7/emulator/peripheral.hpp"
#include "firmware/boards/stm32h7/emulator/sys_tick.hpp"
#include "firmware/boards/stm32h7/emulator/system_control.hpp"

struct uc_struct;  // of unicorn/unicorn.h, which only processor.cpp and exceptions.cpp include

namespace rosflight::boards::stm32h7::emulator {

/// The emulation cannot go on.
class ProcessorError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "what 0x08001234"
std::string at_address(const std::string& what, std::uint32_t address);

/// A Cortex-M7 with memory and peripherals. Unicorn executes the instructions; exceptions, time and
/// the system control space are here.
///
/// Time is a count of instructions, each of the same length, so a run is repeatable to the bit;
/// while the processor sleeps, time jumps to the next event. Events and interrupts take effect
/// between two basic blocks, at most some 20 instructions late. Caches, pipeline and bus contention
/// are not modelled: see SystemControl::cacheable() for what is checked instead.
class Processor final : public Core {
 public:
  struct Counters {
    std::uint64_t instructions{}, exceptions{}, accesses{}, resets{};
    Ticks slept{};
  };

  Processor();
  ~Processor() override;
  Processor(const Processor&) = delete;
  Processor& operator=(const Processor&) = delete;

  enum class Kind : std::uint8_t { kRam, kCode, kFlash };
  /// Memory of the chip; RAM is zero, flash is erased. kFlash is written only by its loader.
  void add_memory(std::uint32_t base, std::size_t size, Kind kind);
  /// A peripheral at its instance's base.
  void add(Peripheral& peripheral);
  /// A model outside of the chip that has events.
  void add(Timed& timed) { timed_.push_back(&timed); }
  /// Call it once, after all add().
  void finish();

  /// Starts at a vector table; peripherals are reset.
  void power_on(std::uint32_t vector_table);
  /// Runs up to this time.
  void run_until(Ticks time);

  Ticks now() const override { return now_; }
  void set_due(Timed& timed, Ticks time) override;
  void set_line(unsigned irq, bool high) override;
  std::uint8_t* memory(std::uint32_t address, std::size_t count) override;
  bool cacheable(std::uint32_t address) const override { return control_.cacheable(address); }
  void request_reset() override;
  void bus_error() override;
  void complain(const std::string& what) override;

  /// Half cycles of the 400 MHz core that one instruction takes: 1.5 cycles at this frequency.
  void set_frequency(std::uint64_t core_Hz);
  /// Whether the peripheral's clock gate is open; asked at each access.
  void set_gate(std::function<bool(const Instance&)> is_open) {
    gate_is_open_ = std::move(is_open);
  }
  /// Called before a reset takes effect, with whether the firmware asked for it.
  std::function<void(bool by_software)> on_reset;
  std::function<void(const std::string&)> on_complaint;
  std::function<void(const std::string&)> on_fault;

  const Counters& counters() const { return counters_; }
  /// Address of the next instruction, between two calls of run_until().
  std::uint32_t stands_at() const { return resume_at_; }
  /// A fault inside the hard fault handler stopped the processor until the next reset.
  bool locked_up() const { return locked_up_; }

 private:
  struct Memory {
    std::uint32_t base{};
    std::size_t size{};
    Kind kind{};
    std::unique_ptr<std::uint8_t, void (*)(void*)> bytes;
  };
  struct Window {
    std::uint32_t base{}, size{};
    Peripheral* peripheral{};
  };
  struct Hooks;  ///< The callbacks of Unicorn.
  friend struct Hooks;

  /// The block that begins at a half word of flash. Small, because it is looked up for each block.
  struct Block {
    std::uint8_t half_words{}, instructions{};
  };
  Block& block_at(std::uint32_t address);
  unsigned count(std::uint32_t address, std::uint32_t size);
  unsigned count_again(std::uint32_t address, std::uint32_t size);
  void charge(unsigned instructions);
  void begin_slowly(std::uint32_t address, std::uint32_t size);
  void run_events();
  void sleep();
  void stop();
  void reset_now();
  std::uint32_t bus_read(std::uint32_t address, unsigned size);
  void bus_write(std::uint32_t address, std::uint32_t value, unsigned size);
  bool asks_again() const;
  void check_return();
  Window* window_at(std::uint32_t address);

  // exceptions.cpp
  std::uint32_t get(int id) const;
  void set(int id, std::uint32_t value) const;
  Nvic::Masks masks() const;
  void enter(int exception, std::uint32_t return_address);
  void leave(std::uint32_t exc_return);
  void raise(int exception, const std::string& what, std::uint32_t status, std::uint32_t address);
  void take_fault();

  uc_struct* uc_{};
  std::vector<Memory> memories_;
  std::vector<Window> windows_;
  std::vector<Timed*> timed_;
  Nvic nvic_;
  SystemControl control_;
  SysTick sys_tick_{*this, nvic_};
  Ticks now_{}, target_{}, next_due_{kNever}, instruction_ticks_{3};
  bool slow_{false};     ///< The next block must look for interrupts.
  bool stopped_{false};  ///< Unicorn was stopped: not a sleep.
  bool reset_requested_{false}, locked_up_{false};
  /// The peripheral whose request the running handler has cleared, until it is read: the write may still be on
  /// its way.
  const Peripheral* cleared_{nullptr};
  int cleared_by_{0};
  int fault_{0};                            ///< Taken when Unicorn has stopped.
  std::optional<std::uint32_t> forbidden_;  ///< Where the MPU has just forbidden an access.
  std::uint32_t resume_at_{}, vector_table_{};
  std::vector<Block> blocks_;
  Memory* newest_memory_{nullptr};  ///< That memory() found last.
  Window* newest_window_{nullptr};  ///< That window_at() found last.
  std::function<bool(const Instance&)> gate_is_open_;
  Counters counters_;
};

}  // namespace rosflight::boards::stm32h7::emulator
