// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <filesystem>
#include <string>

#include "firmware/boards/common/host/child_process.hpp"
#include "firmware/boards/common/host/one_processor.hpp"
#include "firmware/boards/stm32h7/host/exchange.hpp"

namespace rosflight::boards::stm32h7 {

/// Runs an image on the emulated chip: a program of its own, because the engine inside is under the
/// GPL. Every function may throw boards::EmulatorError.
class ChipProcess {
 public:
  struct Options {
    std::filesystem::path program;  ///< h7_emulator.
    std::filesystem::path image;
    std::string board;
    /// Longest silence of the program before it counts as hanging.
    std::chrono::milliseconds timeout{20'000};
  };

  /// Starts nothing yet. @throws EmulatorError  no such program or image; names what makes it.
  explicit ChipProcess(const Options& options);
  ~ChipProcess();
  ChipProcess(const ChipProcess&) = delete;
  ChipProcess& operator=(const ChipProcess&) = delete;

  /// Starts the program; the chip has no power yet.
  void start();
  bool running() const { return child_.running(); }
  pid_t process() const { return child_.process(); }

  ToChip& to_chip() { return block_->to_chip; }
  const FromChip& from_chip() const { return block_->from_chip; }
  /// Carries out the order in to_chip(). @throws EmulatorError  the program died, is silent, or a model
  /// complained of the firmware: then with the first complaint.
  void exchange();

 private:
  Options options_;
  ChildProcess child_;
  OneProcessor one_processor_;
  base::FileDescriptor memory_, to_chip_, from_chip_;
  Exchange* block_{nullptr};
};

}  // namespace rosflight::boards::stm32h7
