// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/children.hpp"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace rosflight::bench::faults {
namespace {

constexpr char kDone = '+';
constexpr char kFailed = '!';
/// Several children write into one pipe: a write of at most PIPE_BUF (4096) bytes is not divided.
constexpr std::size_t kLongest = 3000;

struct Pipe {
  Pipe() {
    if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe to a child process");
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  void close_end(std::size_t which) {
    if (ends.at(which) >= 0) close(ends.at(which));
    ends.at(which) = -1;
  }
  void write(const std::string& line) const {
    std::size_t at = 0;
    while (at < line.size()) {
      const ssize_t written = ::write(ends[1], line.data() + at, line.size() - at);
      if (written < 0 && errno != EINTR) return;  // the parent is gone
      at += written > 0 ? static_cast<std::size_t>(written) : 0;
    }
  }
  /// Calls on_line() for each line until the last writer has closed its end.
  void read(const std::function<void(const std::string&)>& on_line) const {
    std::array<char, 4096> buffer{};
    std::string pending;
    for (;;) {
      const ssize_t count = ::read(ends[0], buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return;
      pending.append(buffer.data(), static_cast<std::size_t>(count));
      for (std::size_t end = pending.find('\n'); end != std::string::npos;
           end = pending.find('\n')) {
        on_line(pending.substr(0, end));
        pending.erase(0, end + 1);
      }
    }
  }

  std::array<int, 2> ends{-1, -1};
};

/// The child runs `work` and ends without the destructors and buffers of its parent.
pid_t start(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no child process");
  if (child > 0) return child;
  work();
  _exit(0);
}

void wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw std::runtime_error("a child process ended before its work was done");
  }
}

/// The result, or the message of what was thrown, as one line without its end.
std::string attempt(const std::function<std::string()>& work) {
  try {
    return kDone + work();
  } catch (const std::exception& e) {
    std::string message = e.what();
    std::ranges::replace(message, '\n', ' ');
    return kFailed + message.substr(0, kLongest);
  }
}

std::string checked(const std::string& line) {
  if (line.empty() || line.front() != kDone) {
    throw std::runtime_error(line.empty() ? "a child process wrote nothing" : line.substr(1));
  }
  return line.substr(1);
}

/// A number that parent and children share.
class SharedCounter {
 public:
  SharedCounter() {
    void* const page =
        mmap(nullptr, sizeof(Counter), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) throw std::runtime_error("no memory that children share");
    counter_ = new (page) Counter{0};
  }
  ~SharedCounter() { munmap(counter_, sizeof(Counter)); }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;

  std::size_t next() { return (*counter_)++; }

 private:
  using Counter = std::atomic<std::size_t>;
  static_assert(Counter::is_always_lock_free);
  Counter* counter_{};
};

}  // namespace

std::string in_child(const std::function<std::string()>& work) {
  Pipe pipe;
  const pid_t child = start([&] { pipe.write(attempt(work) + "\n"); });
  pipe.close_end(1);
  std::string line;
  pipe.read([&line](const std::string& read) { line = read; });
  wait_for(child);
  return checked(line);
}

void in_children(std::size_t count, unsigned children,
                 const std::function<std::string(std::size_t)>& work,
                 const std::function<void(std::size_t, const std::string&)>& on_result) {
  const unsigned wanted =
      children == 0 ? std::max(1U, std::thread::hardware_concurrency()) : children;
  Pipe pipe;
  SharedCounter counter;
  std::vector<pid_t> started;
  for (unsigned k = 0; k < wanted; ++k) {
    started.push_back(start([&] {
      pipe.close_end(0);
      for (std::size_t n = counter.next(); n < count; n = counter.next()) {
        const std::string line = attempt([&work, n] { return work(n); });
        pipe.write(std::to_string(n) + " " + line + "\n");
        if (line.front() == kFailed) return;
      }
    }));
  }
  pipe.close_end(1);
  std::string failure;
  std::size_t done = 0;
  pipe.read([&](const std::string& line) {
    const std::size_t space = line.find(' ');
    try {
      on_result(std::stoul(line.substr(0, space)), checked(line.substr(space + 1)));
      ++done;
    } catch (const std::exception& e) {
      failure = e.what();
    }
  });
  for (const pid_t child : started) {
    try {
      wait_for(child);
    } catch (const std::exception& e) {
      if (failure.empty()) failure = e.what();
    }
  }
  if (failure.empty() && done != count) failure = "a child process wrote too little";
  if (!failure.empty()) throw std::runtime_error(failure);
}

}  // namespace rosflight::bench::faults
