// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "firmware/boards/common/host/child_process.hpp"
#include "firmware/boards/common/host/one_processor.hpp"

namespace rosflight::flight {

/// A program that moves the body, in lock-step: commands and answers are single bytes over two pipes, numbers are in a block of
/// memory that both share. The program finds them as the file descriptors below. It ends with this object
/// and with this program, however that ends. Used in one thread.
class EngineProcess {
 public:
  static constexpr int kCommandsFd = 3;
  static constexpr int kAnswersFd = 4;
  static constexpr int kBlockFd = 5;
  static constexpr char kReady = 'r';  ///< Answer to a command that was done; any other: it failed.

  /// @param part  what errors begin with, such as "--physics jsbsim". @throws boards::EmulatorError
  EngineProcess(const std::string& part, std::size_t block_bytes);
  ~EngineProcess();
  EngineProcess(const EngineProcess&) = delete;
  EngineProcess& operator=(const EngineProcess&) = delete;

  /// @param more  further files for the program. @throws boards::EmulatorError
  void start(const std::vector<std::string>& arguments,
             std::vector<boards::ChildProcess::File> more = {});
  void* block() const { return block_; }
  /// Sends a command and waits until it is done. @param error  text in the block, for the answer that it failed.
  /// @throws boards::EmulatorError  it failed, or the program has ended or does not answer.
  void command(char what, std::chrono::milliseconds timeout, const char* error);
  /// Ends the program. @throws boards::EmulatorError
  [[noreturn]] void give_up(const std::string& why) { child_.give_up(why); }
  pid_t process() const { return child_.process(); }

 private:
  std::string part_;
  boards::ChildProcess child_;
  boards::OneProcessor one_processor_;
  base::FileDescriptor memory_, to_engine_, from_engine_;
  std::size_t bytes_;
  void* block_{nullptr};
};

}  // namespace rosflight::flight
