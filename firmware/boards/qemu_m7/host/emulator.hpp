// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "firmware/boards/common/host/child_process.hpp"
#include "firmware/boards/qemu_m7/exchange_block.hpp"

/// The host's end of the emulated board.
namespace rosflight::boards::m7 {

using boards::EmulatorError;

/// Runs an image in qemu-system-arm, machine mps2-an500, as a child process, and rings its bell.
///
/// Owns the board's external RAM (exchange block and non-volatile storage): that outlives the
/// process, so power_off() and power_on() are what they are for a board. The child dies with this
/// object and with this process, however that ends; nothing is left in the file system.
class Emulator {
 public:
  struct Options {
    std::filesystem::path image;
    Coupling coupling{Coupling::kLockStep};
    std::string program{"qemu-system-arm"};  ///< Looked for in PATH.
    /// Longest silence of the board before it counts as hanging.
    std::chrono::milliseconds timeout{4000};
  };

  /// Starts nothing yet; the storage is blank (0xFF). The process ignores SIGPIPE from now on.
  /// @throws EmulatorError  no such image, or the program is not installed (names the package).
  explicit Emulator(const Options& options);
  ~Emulator();
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;

  /// Starts the process. In lock-step the board will send kBooted; wait_for_answer() takes it.
  void power_on();
  /// Ends the process at once.
  void power_off();
  bool running() const { return child_.running(); }
  pid_t process() const { return child_.process(); }

  ToProcessor& to_processor() { return block().to_processor; }
  const FromProcessor& from_processor() const { return block().from_processor; }
  std::uint8_t* storage() { return memory_ + kStorageOffset; }

  /// Lock-step: signals to the board that to_processor() is ready. @throws EmulatorError if it is gone.
  void ring();
  /// Lock-step: kDone or kBooted. @throws EmulatorError if the board died or kept silent longer
  /// than `timeout`; the process is ended then.
  Bell wait_for_answer();
  /// Real time: @throws EmulatorError if the process has ended.
  void check() { child_.check(); }
  /// Real time: the far end of the board's UART, non-blocking.
  int uart() const { return uart_.get(); }

 private:
  ExchangeBlock& block() { return *reinterpret_cast<ExchangeBlock*>(memory_); }
  const ExchangeBlock& block() const { return *reinterpret_cast<const ExchangeBlock*>(memory_); }
  std::vector<std::string> arguments() const;

  Options options_;
  std::string program_path_;
  base::FileDescriptor ram_;
  std::uint8_t* memory_{nullptr};
  ChildProcess child_;
  base::FileDescriptor bell_out_;
  base::FileDescriptor bell_in_;
  base::FileDescriptor uart_;
};

}  // namespace rosflight::boards::m7
