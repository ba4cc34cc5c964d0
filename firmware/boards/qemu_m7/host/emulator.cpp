// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/qemu_m7/host/emulator.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace rosflight::boards::m7 {
namespace {

// What else the emulator's process finds open, beside the pipes of exchange_block.hpp.
constexpr int kRamFd = 22;
constexpr int kUartFd = 23;
constexpr std::size_t kMostLastWords = 2000;

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

struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("cannot make a pipe");
    read = base::FileDescriptor{ends[0]};
    write = base::FileDescriptor{ends[1]};
  }
  base::FileDescriptor read;
  base::FileDescriptor write;
};

}  // namespace

Emulator::Emulator(const Options& options)
    : options_{options}, program_path_{find_in_path(options.program)} {
  if (!std::filesystem::exists(options_.image)) {
    throw EmulatorError(options_.image.string() +
                        " is not built: tools/ready.sh build cortex-m7 makes it, with the compiler "
                        "of the package gcc-arm-none-eabi");
  }
  std::signal(SIGPIPE, SIG_IGN);  // a dead emulator shows as an error of write()
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
  to_board().coupling = options_.coupling;
  last_words_.clear();
  Pipe to_board_pipe;
  Pipe from_board_pipe;
  Pipe said_pipe;
  std::array<int, 2> uart{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, uart.data()) != 0) fail("socketpair");
  uart_ = base::FileDescriptor{uart[0]};
  const base::FileDescriptor board_uart{uart[1]};
  const pid_t parent = ::getpid();
  child_ = ::fork();
  if (child_ < 0) fail("cannot start " + program_path_);
  if (child_ == 0) {
    // Whatever becomes of this program, the emulator goes with it.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    become_emulator(to_board_pipe.read.get(), from_board_pipe.write.get(), said_pipe.write.get(),
                    board_uart.get());
  }
  bell_out_ = std::move(to_board_pipe.write);
  bell_in_ = std::move(from_board_pipe.read);
  said_ = std::move(said_pipe.read);
  ::fcntl(said_.get(), F_SETFL, O_NONBLOCK);
  ::fcntl(uart_.get(), F_SETFL, O_NONBLOCK);
}

void Emulator::become_emulator(int to_board, int from_board, int said, int uart) const {
  // Out of the way first, so that no number is taken while it is still needed.
  constexpr int kAside = 100;
  const int in = ::fcntl(to_board, F_DUPFD, kAside);
  const int out = ::fcntl(from_board, F_DUPFD, kAside);
  const int words = ::fcntl(said, F_DUPFD, kAside);
  const int wire = ::fcntl(uart, F_DUPFD, kAside);
  const int ram = ::fcntl(ram_.get(), F_DUPFD, kAside);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing < 0) ::_exit(1);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(words, STDOUT_FILENO);
  ::dup2(words, STDERR_FILENO);
  ::dup2(in, kToBoardFd);
  ::dup2(out, kFromBoardFd);
  ::dup2(ram, kRamFd);
  ::dup2(wire, kUartFd);
  for (const int fd : {in, out, words, wire, ram}) ::close(fd);
  static_assert(kToBoardFd == 20 && kFromBoardFd == 21 && kRamFd == 22 && kUartFd == 23);
  std::vector<const char*> arguments{
      program_path_.c_str(),
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
      options_.image.c_str()};
  if (options_.coupling == Coupling::kLockStep) {
    // One instruction is one nanosecond of the board's time: a run is repeatable to the bit.
    arguments.insert(arguments.end(), {"-icount", "shift=0,sleep=off"});
  }
  arguments.push_back(nullptr);
  ::execv(program_path_.c_str(), const_cast<char* const*>(arguments.data()));
  ::_exit(127);
}

void Emulator::power_off() {
  if (child_ > 0) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    child_ = -1;
  }
  bell_out_.close();
  bell_in_.close();
  said_.close();
  uart_.close();
}

void Emulator::listen() {
  std::array<char, 512> text{};
  for (;;) {
    const ssize_t count = ::read(said_.get(), text.data(), text.size());
    if (count <= 0) return;
    last_words_.append(text.data(), static_cast<std::size_t>(count));
    if (last_words_.size() > kMostLastWords) {
      last_words_.erase(0, last_words_.size() - kMostLastWords);
    }
  }
}

void Emulator::give_up(const std::string& why) {
  listen();
  std::string text = "emulated board: " + why;
  while (!last_words_.empty() && last_words_.back() == '\n') last_words_.pop_back();
  text += last_words_.empty() ? "; it said nothing" : "; it said last:\n" + last_words_;
  power_off();
  throw EmulatorError(text);
}

void Emulator::check() {
  int status = 0;
  if (child_ > 0 && ::waitpid(child_, &status, WNOHANG) == 0) return listen();
  child_ = -1;
  give_up(WIFSIGNALED(status)
              ? "the emulator was ended by signal " + std::to_string(WTERMSIG(status))
              : "the emulator ended with status " + std::to_string(WEXITSTATUS(status)));
}

void Emulator::ring() {
  ++to_board().sequence;
  const Bell what = Bell::kRing;
  const bool written = ::write(bell_out_.get(), &what, 1) == 1;
  if (!written) check();
}

Bell Emulator::wait_for_answer() {
  const auto end = std::chrono::steady_clock::now() + options_.timeout;
  for (;;) {
    std::array<pollfd, 2> ready{{{bell_in_.get(), POLLIN, 0}, {said_.get(), POLLIN, 0}}};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    const int count = ::poll(ready.data(), ready.size(),
                             static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (count == 0) {
      give_up("no answer for " + std::to_string(options_.timeout.count()) + " ms");
    }
    if ((ready[0].revents & POLLIN) != 0) {
      Bell said{};
      if (::read(bell_in_.get(), &said, 1) == 1) return said;
    }
    if ((ready[1].revents & POLLIN) != 0) listen();
    if (((ready[0].revents | ready[1].revents) & POLLHUP) != 0) {
      int status = 0;
      ::waitpid(child_, &status, 0);
      child_ = -1;
      give_up(WIFSIGNALED(status)
                  ? "the emulator was ended by signal " + std::to_string(WTERMSIG(status))
                  : "the emulator ended with status " + std::to_string(WEXITSTATUS(status)));
    }
  }
}

}  // namespace rosflight::boards::m7
