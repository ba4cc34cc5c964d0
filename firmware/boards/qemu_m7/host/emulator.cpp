// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/qemu_m7/host/emulator.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace rosflight::boards::m7 {
namespace {

// What else the emulator's process finds open, beside the pipes of exchange_block.hpp.
constexpr int kRamFd = 22;
constexpr int kUartFd = 23;

[[noreturn]] void fail(const std::string& what) {
  throw EmulatorError(what + ": " + std::strerror(errno));
}

std::string find_in_path(const std::string& program) {
  if (program.find('/') != std::string::npos) return program;
  const char* const path = std::getenv("PATH");
  std::string folders = path != nullptr ? path : "/usr/bin";
  for (std::size_t at = 0; at <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', at), folders.size());
    const std::string candidate = folders.substr(at, end - at) + "/" + program;
    if (::access(candidate.c_str(), X_OK) == 0) return candidate;
    at = end + 1;
  }
  throw EmulatorError(program + " is not installed: it comes with the package " + program);
}

}  // namespace

Emulator::Emulator(const Options& options)
    : options_{options}, program_path_{find_in_path(options.program)} {
  if (!std::filesystem::exists(options_.image)) {
    throw EmulatorError(options_.image.string() +
                        " is not built: tools/ready.sh build cortex-m7 makes it, with the compiler "
                        "of the package gcc-arm-none-eabi");
  }
  ram_ = base::FileDescriptor{::memfd_create("rosflight_m7", MFD_CLOEXEC)};
  if (!ram_.valid() || ::ftruncate(ram_.get(), kExternalRamSize) != 0) {
    fail("cannot get memory for the emulated board");
  }
  void* const mapped =
      ::mmap(nullptr, kExternalRamSize, PROT_READ | PROT_WRITE, MAP_SHARED, ram_.get(), 0);
  if (mapped == MAP_FAILED) fail("cannot map memory for the emulated board");
  memory_ = static_cast<std::uint8_t*>(mapped);
  std::memset(storage(), 0xFF, kStorageSize);
}

Emulator::~Emulator() {
  power_off();
  ::munmap(memory_, kExternalRamSize);
}

void Emulator::power_on() {
  power_off();
  block() = ExchangeBlock{};
  to_processor().coupling = options_.coupling;
  Pipe to_board_pipe;
  Pipe from_board_pipe;
  std::array<int, 2> uart{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, uart.data()) != 0) fail("socketpair");
  uart_ = base::FileDescriptor{uart[0]};
  const base::FileDescriptor board_uart{uart[1]};
  child_.start(arguments(), {{to_board_pipe.read.get(), kToProcessorFd},
                             {from_board_pipe.write.get(), kFromProcessorFd},
                             {ram_.get(), kRamFd},
                             {board_uart.get(), kUartFd}});
  bell_out_ = std::move(to_board_pipe.write);
  bell_in_ = std::move(from_board_pipe.read);
  ::fcntl(uart_.get(), F_SETFL, O_NONBLOCK);
}

std::vector<std::string> Emulator::arguments() const {
  static_assert(kRamFd == 22 && kUartFd == 23);
  std::vector<std::string> arguments{
      program_path_,
      "-M",
      "mps2-an500,memory-backend=ram",
      "-object",
      "memory-backend-file,id=ram,share=on,size=16M,mem-path=/proc/self/fd/22",
      "-nodefaults",
      "-display",
      "none",
      "-monitor",
      "none",
      "-semihosting-config",
      "enable=on,target=native",
      "-chardev",
      "socket,id=uart,fd=23",
      "-serial",
      "chardev:uart",
      "-kernel",
      options_.image.string()};
  if (options_.coupling == Coupling::kLockStep) {
    // One instruction is one nanosecond of the board's time: a run is repeatable to the bit.
    arguments.insert(arguments.end(), {"-icount", "shift=0,sleep=off"});
  }
  return arguments;
}

void Emulator::power_off() {
  child_.stop();
  bell_out_.close();
  bell_in_.close();
  uart_.close();
}

void Emulator::ring() {
  ++to_processor().sequence;
  child_.send(bell_out_.get(), static_cast<char>(Bell::kRing));
}

Bell Emulator::wait_for_answer() {
  return static_cast<Bell>(child_.receive(bell_in_.get(), options_.timeout));
}

}  // namespace rosflight::boards::m7
