// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/types.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/file_descriptor.hpp"

namespace rosflight::boards {

/// One line for a person, then the last output of the program.
class EmulatorError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Both ends of a pipe. @throws EmulatorError
struct Pipe {
  Pipe();
  base::FileDescriptor read;
  base::FileDescriptor write;
};

/// A program that emulates a board or another part of the world, as a child of this process: its open files,
/// its last words, its end. The child dies with this object and with this process, however that ends.
///
/// It leads a process group of its own. So Ctrl-C in a terminal, which signals the group in the foreground, reaches this process
/// only, and what the child has started ends with it: a program behind a script does. If this process is killed
/// by SIGKILL, the kernel ends the child alone.
class ChildProcess {
 public:
  /// A file of this process and the number the child finds it under.
  struct File {
    int from;
    int to;
  };

  /// @param part  what it stands for; errors begin with it.
  explicit ChildProcess(std::string part = "emulated board") : part_{std::move(part)} {}
  ~ChildProcess() { stop(); }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// @param arguments  the first is the program's path. @throws EmulatorError
  void start(const std::vector<std::string>& arguments, const std::vector<File>& files);
  /// Ends it and what it has started at once.
  void stop();
  bool running() const { return child_ > 0; }
  pid_t process() const { return child_; }

  /// Writes one byte. @throws EmulatorError if the child is gone.
  void send(int fd, char byte);
  /// Waits for one byte. @throws EmulatorError if the child ends or is silent longer than `timeout`; it
  /// is ended then.
  char receive(int fd, std::chrono::milliseconds timeout);
  /// @throws EmulatorError if it has ended.
  void check();
  /// Ends it. @throws EmulatorError  `why` and its last words.
  [[noreturn]] void give_up(const std::string& why);

 private:
  void listen();
  int end_group();
  [[noreturn]] void report_end();
  [[noreturn]] static void become(const std::vector<std::string>& arguments,
                                  const std::vector<File>& files, int said);

  std::string part_;
  pid_t child_{-1};
  base::FileDescriptor said_;  ///< Standard output and error of the child.
  std::string last_words_;
};

}  // namespace rosflight::boards
