// SPDX-License-Identifier: BSD-3-Clause
// Interrupts of the emulated processor, executed: small programs in machine code.
#include "firmware/boards/stm32h7/emulator/processor.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <string>
#include <utility>

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

constexpr std::uint32_t kFlash = 0x0800'0000U, kRam = 0x2000'0000U;
constexpr std::uint32_t kStart = kFlash + 0xF00, kHandler = kFlash + 0xF40;
/// A condition for four instructions; two of them lie on the next page, so a basic block ends inside.
constexpr std::uint32_t kBlock = kFlash + 0xFFA;
constexpr std::uint16_t kIfEqual = 0xBF01, kIfNotEqual = 0xBF1F;  ///< The instruction itttt.

/// Asks for interrupt 0 at a time; a write to its status register clears the request.
class Request final : public Peripheral {
 public:
  explicit Request(Core& core) : Peripheral{core, "request", "TIM", TIM7} {}
  void event(Ticks /*now*/) override { core().set_line(0, true); }

 private:
  void write(std::uint32_t /*offset*/, std::uint32_t /*value*/, unsigned /*size*/) override {
    core().set_line(0, false);
  }
};

class Program {
 public:
  /// @param condition   The compared values are equal.
  /// @param reads_back  The handler reads the register that it has written.
  Program(Ticks interrupt, std::uint16_t condition, bool reads_back) {
    processor_.add_memory(kFlash, 0x2000, Processor::Kind::kFlash);
    processor_.add_memory(kRam, 0x1000, Processor::Kind::kRam);
    processor_.add(request_);
    processor_.finish();
    processor_.on_complaint = [this](const std::string& what) { complaints_ += what + "\n"; };
    put(kFlash, {0x1000, 0x2000, (kStart | 1U) & 0xFFFFU, kStart >> 16U});
    put(kFlash + 4 * kFirstIrq, {(kHandler | 1U) & 0xFFFFU, kHandler >> 16U});
    put(kStart, {0x2200,                            // movs r2, #0
                 0xF240, 0x0300,                    // movw r3, #0
                 0xF2C2, 0x0300,                    // movt r3, #0x2000
                 0xF24E, 0x1000,                    // movw r0, #0xE100: ISER0
                 0xF2CE, 0x0000,                    // movt r0, #0xE000
                 0x2101,                            // movs r1, #1
                 0x6001,                            // str r1, [r0]
                 0x2A00,                            // cmp r2, #0
                 0xE06F});                          // b kBlock
    put(kBlock, {condition,                         // itttt
                 0x3201,                            // add r2, #1
                 0x3202,                            // add r2, #2
                 0x3204,                            // add r2, #4
                 0x3208,                            // add r2, #8
                 0x601A,                            // str r2, [r3]
                 0xE7FE});                          // b .
    put(kHandler, {0xF241, 0x4510,                  // movw r5, #0x1410: the status register of TIM7
                   0xF2C4, 0x0500,                  // movt r5, #0x4000
                   0x2400,                          // movs r4, #0
                   0x602C,                          // str r4, [r5]
                   reads_back ? 0x682CU : 0xBF00U,  // ldr r4, [r5], or nop
                   0x685C,                          // ldr r4, [r3, #4]
                   0x3401,                          // adds r4, #1
                   0x605C,                          // str r4, [r3, #4]
                   0x4770});                        // bx lr
    processor_.power_on(kFlash);
    processor_.set_due(request_, interrupt);
    processor_.run_until(2000);
  }

  std::uint32_t result() { return word(kRam); }
  std::uint32_t handled() { return word(kRam + 4); }
  const std::string& complaints() const { return complaints_; }

 private:
  void put(std::uint32_t address, std::initializer_list<std::uint32_t> half_words) {
    for (const std::uint32_t each : half_words) {
      const auto half = static_cast<std::uint16_t>(each);
      std::memcpy(processor_.memory(address, sizeof half), &half, sizeof half);
      address += sizeof half;
    }
  }
  std::uint32_t word(std::uint32_t address) {
    std::uint32_t value = 0;
    std::memcpy(&value, processor_.memory(address, sizeof value), sizeof value);
    return value;
  }

  Processor processor_;
  Request request_{processor_};
  std::string complaints_;
};

/// Armv7-M ARM B1.5.6: entry stores what is left of an IT block, and return restores it.
TEST(Processor, AnInterruptAtAnyTimeChangesNothingOfAConditionalBlock) {
  for (Ticks at = 1; at < 120; at += 3) {
    for (const auto& [condition, result] :
         {std::pair{kIfEqual, 1U + 2U + 4U + 8U}, std::pair{kIfNotEqual, 0U}}) {
      Program program{at, condition, true};
      ASSERT_EQ(program.result(), result) << "interrupted after " << at;
      ASSERT_EQ(program.handled(), 1U) << "interrupted after " << at;
      ASSERT_EQ(program.complaints(), "");
    }
  }
}

TEST(Processor, AHandlerReadsBackWhatClearsItsRequest) {
  Program program{1, kIfEqual, false};
  EXPECT_NE(program.complaints().find("request: its handler ends without reading back"),
            std::string::npos)
      << program.complaints();
}

/// Region 0 of the MPU forbids the second kilobyte of RAM: a word below it is written, one in it is read.
TEST(Processor, WhatTheMpuForbidsIsAFaultOfItsOwn) {
  constexpr std::uint32_t kForbidden = kFlash + 0x800, kMemoryHandler = kForbidden + 0x2E;
  constexpr std::uint16_t kProgram[] = {
      0x480F, 0xF44F, 0x3180, 0x6001,          // SHCSR: MEMFAULTENA
      0x480E, 0x2100, 0x6001,                  // MPU_RNR: 0
      0x490E, 0x6041,                          // MPU_RBAR: 0x20000400
      0x2113, 0x6081,                          // MPU_RASR: 1 KiB, no access, on
      0x2105, 0x4A0C, 0x6011,                  // MPU_CTRL: on, the default map beside
      0xF04F, 0x5300, 0x2101, 0x6019,          // 1 to 0x20000000
      0xF8D3, 0x4400,                          // ldr r4, [r3, #0x400]
      0x2102, 0x6019, 0xE7FE,                  // 2 to 0x20000000; b .
      0xF04F, 0x5300, 0x2103, 0x6059,          // the handler: 3 to 0x20000004
      0x4806, 0x6801, 0x6099, 0xE7FE, 0xBF00,  // CFSR to 0x20000008; b .
      0xED24, 0xE000, 0xED98, 0xE000, 0x0400, 0x2000, 0xED94, 0xE000, 0xED28, 0xE000};
  Processor processor;
  processor.add_memory(kFlash, 0x2000, Processor::Kind::kFlash);
  processor.add_memory(kRam, 0x1000, Processor::Kind::kRam);
  processor.finish();
  const auto put = [&processor](std::uint32_t address, const void* data, std::size_t size) {
    std::memcpy(processor.memory(address, size), data, size);
  };
  const auto word = [&processor](std::uint32_t address) {
    std::uint32_t value = 0;
    std::memcpy(&value, processor.memory(address, sizeof value), sizeof value);
    return value;
  };
  const std::uint32_t vectors[] = {kRam + 0x1000, kForbidden | 1U};
  const std::uint32_t handler = kMemoryHandler | 1U;
  put(kFlash, vectors, sizeof vectors);
  put(kFlash + 4 * kMemoryFault, &handler, sizeof handler);
  put(kForbidden, kProgram, sizeof kProgram);
  processor.power_on(kFlash);
  processor.run_until(2000);
  EXPECT_EQ(word(kRam), 1U) << "and nothing behind the forbidden access was executed";
  EXPECT_EQ(word(kRam + 4), 3U) << "the handler ran";
  EXPECT_EQ(word(kRam + 8), 0x82U) << "CFSR: a data access, its address is known";
}

/// Far from each other, as with libunicorn.a or the processor in the program, flights are slower: a call over more than 2 GB goes by a register.
TEST(Engine, LiesNearTheProcessorThatItCalls) {
  const void* const engine = dlsym(RTLD_DEFAULT, "uc_open");
  ASSERT_NE(engine, nullptr);
  const auto place = [](const void* at) {
    Dl_info info{};
    EXPECT_NE(dladdr(at, &info), 0);
    return reinterpret_cast<std::intptr_t>(info.dli_fbase);
  };
  const void* const processor = reinterpret_cast<const void*>(&at_address);
  constexpr std::intptr_t kNear = std::intptr_t{1} << 31;
  EXPECT_LT(std::abs(place(engine) - place(processor)), kNear);
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
