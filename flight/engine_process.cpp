// SPDX-License-Identifier: BSD-3-Clause
#include "flight/engine_process.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <utility>

namespace rosflight::flight {

EngineProcess::EngineProcess(const std::string& part, std::size_t block_bytes)
    : part_{part},
      child_{part},
      memory_{::memfd_create("rosflight_engine", MFD_CLOEXEC)},
      bytes_{block_bytes} {
  if (!memory_.valid() || ::ftruncate(memory_.get(), static_cast<off_t>(bytes_)) != 0)
    throw boards::EmulatorError(part_ + ": cannot get memory to share with its process");
  block_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, memory_.get(), 0);
  if (block_ == MAP_FAILED)
    throw boards::EmulatorError(part_ + ": cannot map the memory of its process");
}

EngineProcess::~EngineProcess() {
  child_.stop();
  ::munmap(block_, bytes_);
}

void EngineProcess::start(const std::vector<std::string>& arguments,
                          std::vector<boards::ChildProcess::File> more) {
  boards::Pipe commands;
  boards::Pipe answers;
  more.push_back({commands.read.get(), kCommandsFd});
  more.push_back({answers.write.get(), kAnswersFd});
  more.push_back({memory_.get(), kBlockFd});
  child_.start(arguments, more);
  to_engine_ = std::move(commands.write);
  from_engine_ = std::move(answers.read);
}

void EngineProcess::command(char what, std::chrono::milliseconds timeout, const char* error) {
  one_processor_.next_turn(child_.process());
  child_.send(to_engine_.get(), what);
  if (child_.receive(from_engine_.get(), timeout) == kReady) return;
  child_.stop();
  throw boards::EmulatorError(part_ + ": " + error);
}

}  // namespace rosflight::flight
