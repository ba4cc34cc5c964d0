// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/emulate.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "firmware/boards/stm32h7/emulator/elf_file.hpp"
#include "firmware/boards/stm32h7/emulator/pixracer_pro_model.hpp"
#include "firmware/boards/stm32h7/emulator/varmint_model.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

/// Where an image may begin: at the flash, or behind the first sector and somebody else's bootloader.
constexpr std::uint32_t kImageBases[] = {0x0800'0000U, 0x0802'0000U};

/// Runs orders from the block until the other end of the pipe closes.
class Session {
 public:
  /// @param board_name  of the emulated board, which the image has to be for.
  Session(EmulatedHardware& board, const std::string& board_name, const ElfFile& image,
          Exchange& block)
      : board_{board}, chip_{board.chip()}, image_{image}, block_{block} {
    chip_.processor.on_complaint = [this](const std::string& what) { note(what); };
    chip_.processor.on_fault = [this](const std::string& what) {
      std::fprintf(stderr, "[%lld us] %s\n", static_cast<long long>(now_us()), what.c_str());
    };
    const auto& segments = image.segments;
    for (const auto& segment : segments) {
      const bool begins = std::find(std::begin(kImageBases), std::end(kImageBases),
                                    segment.address) != std::end(kImageBases);
      if (begins) base_ = segment.address;
    }
    if (base_ == 0) {
      throw ProcessorError(
          "the image has no vector table at 0x08000000; is it one of another board?");
    }
    for (const ElfFile::Segment& segment : segments) {
      std::uint8_t* const place = chip_.processor.memory(segment.address, segment.bytes.size());
      if (place == nullptr) throw ProcessorError("the image does not fit the chip's memory");
      std::copy(segment.bytes.begin(), segment.bytes.end(), place);
    }
    check_board(board_name);
    glance_ = variable("board_glance", sizeof(FirmwareGlance));
    find_stack();
  }

  void run() {
    char byte = 0;
    while (::read(kToChipFd, &byte, 1) == 1) {
      serve(block_.to_chip);
      report();
      if (::write(kFromChipFd, &byte, 1) != 1) return;
    }
  }

 private:
  std::int64_t now_us() const {
    return static_cast<std::int64_t>(chip_.processor.now() / kTicksPerMicrosecond);
  }

  /// @throws ProcessorError  the image is for another board. One without symbols is taken as it is.
  void check_board(const std::string& expected) {
    constexpr std::size_t kMaxName = 32;
    const std::uint8_t* const at = variable("board_name", kMaxName);
    if (at == nullptr) return;
    std::string found(reinterpret_cast<const char*>(at), kMaxName);
    found.resize(std::min(found.find('\0'), kMaxName));
    if (found != expected)
      throw ProcessorError("image: found one for " + found + ", allowed one for " + expected +
                           ": ./rosflight firmware build " + expected + " makes it");
  }

  void serve(const ToChip& order) {
    Processor& processor = chip_.processor;
    if (order.order == ChipOrder::kPowerOn) {
      chip_.power_on(base_);
      board_.power_on();
    }
    board_.expose(order);
    board_.inject(order);
    processor.run_until(static_cast<Ticks>(order.until_us) * kTicksPerMicrosecond);
  }

  void report() {
    FromChip& out = block_.from_chip;
    const Processor::Counters& counters = chip_.processor.counters();
    board_.report(out);
    for (const std::string& each : board_.complaints()) note(each);
    out.time_us = now_us();
    out.instructions = counters.instructions;
    out.busy_us = (chip_.processor.now() - counters.slept) / kTicksPerMicrosecond;
    out.flash_operations = chip_.flash.sectors.operations;
    out.resets = static_cast<std::uint32_t>(counters.resets);
    out.complaints = complaints_;
    out.in_bootloader = static_cast<std::uint8_t>(chip_.in_bootloader());
    if (out.clock_zero_us >= 0) out.stack_bytes = stack_high_water();  // painted by then
    if (glance_ != nullptr) {
      std::memcpy(&out.firmware, glance_, sizeof(FirmwareGlance));
      out.stamp_error_us = board_.stamp_error_us(out.firmware.imu_stamp_us);
    }
  }

  /// A variable of the firmware, found by its name as a debugger would.
  const std::uint8_t* variable(const std::string& name, std::size_t size) {
    const auto found = image_.symbols.find(name);
    return found == image_.symbols.end() ? nullptr : chip_.processor.memory(found->second, size);
  }

  void find_stack() {
    const auto bottom = image_.symbols.find("board_stack_bottom");
    const auto top = image_.symbols.find("board_stack_top");
    if (bottom == image_.symbols.end() || top == image_.symbols.end()) return;
    const std::uint8_t* const from =
        chip_.processor.memory(bottom->second, top->second - bottom->second);
    if (from == nullptr) return;
    stack_bottom_ = reinterpret_cast<const std::uint32_t*>(from);
    constexpr std::uint32_t kWord = sizeof(std::uint32_t);
    const std::uint32_t words = (top->second - bottom->second) / kWord;
    stack_top_ = stack_bottom_ + words;
  }

  /// Bytes from the lowest word that has lost its paint to the top.
  std::uint32_t stack_high_water() const {
    const auto is_paint = [](std::uint32_t word) { return word == 0xC0DE'FACEU; };
    const auto used = std::find_if_not(stack_bottom_, stack_top_, is_paint);
    return static_cast<std::uint32_t>(sizeof *used) * static_cast<std::uint32_t>(stack_top_ - used);
  }

  void note(const std::string& what) {
    constexpr std::uint32_t kShown = 20;
    ++complaints_;
    if (complaints_ <= kShown) std::fprintf(stderr, "%s\n", what.c_str());
    if (complaints_ > 1) return;
    auto& text = block_.from_chip.text;
    const std::size_t count = std::min(what.size(), text.size() - 1);
    std::copy_n(what.begin(), count, text.begin());
    text[count] = 0;
  }

  EmulatedHardware& board_;
  Chip& chip_;
  const ElfFile& image_;
  Exchange& block_;
  const std::uint8_t* glance_{nullptr};  ///< These three are the image's, if it has them.
  const std::uint32_t *stack_bottom_{nullptr}, *stack_top_{nullptr};
  std::uint32_t base_{0};
  std::uint32_t complaints_{0};
};

std::unique_ptr<EmulatedHardware> make_board(const std::string& name) {
  if (name == "pixracer_pro") return std::make_unique<PixracerProModel>();
  using Revision = VarmintModel::Revision;
  if (name == "varmint") return std::make_unique<VarmintModel>(Revision::k11X);
  if (name == "varmint_10x") return std::make_unique<VarmintModel>(Revision::k10X);
  throw ProcessorError("board: found " + name + ", allowed pixracer_pro, varmint, varmint_10x");
}

Exchange& map_block() {
  void* const memory =
      ::mmap(nullptr, sizeof(Exchange), PROT_READ | PROT_WRITE, MAP_SHARED, kBlockFd, 0);
  if (memory == MAP_FAILED)
    throw ProcessorError("no block of memory at file 22: rosflight starts this program");
  return *static_cast<Exchange*>(memory);
}

}  // namespace

int emulate(int argc, char** argv) {
  try {
    if (argc != 3) throw ProcessorError("usage: h7_emulator BOARD IMAGE.elf, started by rosflight");
    const auto board = make_board(argv[1]);
    const ElfFile image = ElfFile::read(argv[2]);
    Session(*board, argv[1], image, map_block()).run();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "h7_emulator: %s\n", error.what());
    return 1;
  }
}

}  // namespace rosflight::boards::stm32h7::emulator
