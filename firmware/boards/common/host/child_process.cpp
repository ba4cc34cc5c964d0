// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/common/host/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

namespace rosflight::boards {
namespace {

constexpr std::size_t kMaxLastWords = 2000;

[[noreturn]] void fail(const std::string& what) {
  throw EmulatorError(what + ": " + std::strerror(errno));
}

}  // namespace

Pipe::Pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("cannot make a pipe");
  read = base::FileDescriptor{ends[0]};
  write = base::FileDescriptor{ends[1]};
}

void ChildProcess::start(const std::vector<std::string>& arguments,
                         const std::vector<File>& files) {
  stop();
  std::signal(SIGPIPE, SIG_IGN);  // a dead child shows as an error of write()
  last_words_.clear();
  Pipe said;
  const pid_t parent = ::getpid();
  child_ = ::fork();
  if (child_ < 0) fail("cannot start " + arguments.front());
  if (child_ == 0) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    become(arguments, files, said.write.get());
  }
  ::setpgid(child_, child_);  // before its exec; later it fails and has been done
  said_ = std::move(said.read);
  ::fcntl(said_.get(), F_SETFL, O_NONBLOCK);
}

void ChildProcess::become(const std::vector<std::string>& arguments, const std::vector<File>& files,
                          int said) {
  // Out of the way first, so that no number is taken while it is still needed.
  constexpr int kAside = 100;
  std::vector<File> aside;
  aside.reserve(files.size());
  for (const File& file : files) aside.push_back({::fcntl(file.from, F_DUPFD, kAside), file.to});
  const int words = ::fcntl(said, F_DUPFD, kAside);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing < 0) ::_exit(1);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(words, STDOUT_FILENO);
  ::dup2(words, STDERR_FILENO);
  ::close(words);
  for (const File& file : aside) {
    ::dup2(file.from, file.to);
    ::close(file.from);
  }
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments)
    pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  ::execv(pointers.front(), pointers.data());
  ::_exit(127);
}

/// Ends what is left of the group, then reaps the child: until then no other process can have its number.
/// @returns its status.
int ChildProcess::end_group() {
  int status = 0;
  ::kill(-child_, SIGKILL);
  ::waitpid(child_, &status, 0);
  child_ = -1;
  return status;
}

void ChildProcess::stop() {
  if (child_ > 0) end_group();
  said_.close();
}

void ChildProcess::listen() {
  std::array<char, 512> text{};
  for (;;) {
    const ssize_t count = ::read(said_.get(), text.data(), text.size());
    if (count <= 0) return;
    last_words_.append(text.data(), static_cast<std::size_t>(count));
    if (last_words_.size() > kMaxLastWords) {
      last_words_.erase(0, last_words_.size() - kMaxLastWords);
    }
  }
}

void ChildProcess::give_up(const std::string& why) {
  listen();
  std::string text = part_ + ": " + why;
  while (!last_words_.empty() && last_words_.back() == '\n') last_words_.pop_back();
  const bool one_line = last_words_.find('\n') == std::string::npos;
  text += last_words_.empty()
              ? "; it printed nothing"
              : std::string("; its last output:") + (one_line ? ' ' : '\n') + last_words_;
  stop();
  throw EmulatorError(text);
}

void ChildProcess::report_end() {
  const int status = child_ > 0 ? end_group() : 0;
  give_up(WIFSIGNALED(status)
              ? "its program was ended by signal " + std::to_string(WTERMSIG(status))
              : "its program ended with status " + std::to_string(WEXITSTATUS(status)));
}

void ChildProcess::check() {
  siginfo_t ended{};
  if (child_ > 0 &&
      ::waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
      ended.si_pid == 0) {
    return listen();
  }
  report_end();
}

void ChildProcess::send(int fd, char byte) {
  if (::write(fd, &byte, 1) != 1) check();
}

char ChildProcess::receive(int fd, std::chrono::milliseconds timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    std::array<pollfd, 2> ready{{{fd, POLLIN, 0}, {said_.get(), POLLIN, 0}}};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    const int count = ::poll(ready.data(), ready.size(),
                             static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (count == 0) give_up("no answer for " + std::to_string(timeout.count()) + " ms");
    if ((ready[0].revents & POLLIN) != 0) {
      char byte = 0;
      if (::read(fd, &byte, 1) == 1) return byte;
    }
    if ((ready[1].revents & POLLIN) != 0) listen();
    if (((ready[0].revents | ready[1].revents) & POLLHUP) != 0) {
      siginfo_t ended{};
      ::waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOWAIT);
      report_end();
    }
  }
}

}  // namespace rosflight::boards
