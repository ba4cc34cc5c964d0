// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace rosflight::boards::stm32h7::emulator {

/// An executable image for the chip: what goes to memory, and the addresses of its symbols.
struct ElfFile {
  struct Segment {
    std::uint32_t address{};  ///< Where it is loaded (flash).
    std::vector<std::uint8_t> bytes;
  };
  std::vector<Segment> segments;
  std::map<std::string, std::uint32_t> symbols;

  /// @throws ProcessorError  with one line: no file, or none for a 32-bit Arm.
  static ElfFile read(const std::filesystem::path& path);
};

}  // namespace rosflight::boards::stm32h7::emulator
