// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/common/host/child_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace rosflight::boards {
namespace {

using namespace std::chrono_literals;

/// A script that starts a program and waits for it, as the start scripts of packaged games do. The program's
/// number is in a file.
class Script {
 public:
  /// @param after  what the script does once the program runs.
  explicit Script(const std::string& after)
      : command_{"sleep 100 & echo $! >" + file_ + ";" + after} {}
  ~Script() {
    if (program_ > 0) ::kill(program_, SIGKILL);
    std::filesystem::remove(file_);
  }
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;

  std::vector<std::string> command() const { return {"/bin/sh", "-c", command_}; }
  /// Waits until the program runs.
  pid_t program() {
    while (program_ <= 0) std::ifstream(file_) >> program_;
    return program_;
  }

 private:
  std::string file_{[] {
    std::string pattern = (std::filesystem::temp_directory_path() / "script_XXXXXX").string();
    ::close(::mkstemp(pattern.data()));
    return pattern;
  }()};
  std::string command_;
  pid_t program_{0};
};

/// Whether a process runs; one that has ended and that nobody has reaped yet does not.
bool runs(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string stat;
  std::getline(file, stat);
  const std::size_t name_end = stat.rfind(')');
  return name_end != std::string::npos && stat.at(name_end + 2) != 'Z';
}

bool ends_soon(pid_t process) {
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (runs(process) && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
  return !runs(process);
}

TEST(ChildProcess, HasAProcessGroupOfItsOwn) {
  ChildProcess child;
  child.start({"/bin/sleep", "100"}, {});
  EXPECT_EQ(::getpgid(child.process()), child.process());
  EXPECT_NE(::getpgid(0), child.process());
}

TEST(ChildProcess, AProgramBehindAScriptEndsWithIt) {
  Script script("wait");
  ChildProcess child;
  child.start(script.command(), {});
  const pid_t program = script.program();
  ASSERT_TRUE(runs(program));
  child.stop();
  EXPECT_TRUE(ends_soon(program));
}

TEST(ChildProcess, AProgramWhoseScriptHasEndedEndsWhenThatIsReported) {
  Script script("exit 3");
  ChildProcess child("engine");
  child.start(script.command(), {});
  const pid_t program = script.program();
  std::string why;
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (why.empty() && std::chrono::steady_clock::now() < end) {
    try {
      child.check();
    } catch (const EmulatorError& error) {
      why = error.what();
    }
  }
  EXPECT_EQ(why, "engine: its program ended with status 3; it printed nothing");
  EXPECT_TRUE(ends_soon(program));
  EXPECT_FALSE(child.running());
}

TEST(ChildProcess, ASignalThatEndedItIsReported) {
  ChildProcess child("engine");
  child.start({"/bin/sh", "-c", "kill -TERM $$"}, {});
  std::string why;
  while (why.empty()) {
    try {
      child.check();
    } catch (const EmulatorError& error) {
      why = error.what();
    }
  }
  EXPECT_EQ(why, "engine: its program was ended by signal 15; it printed nothing");
}

}  // namespace
}  // namespace rosflight::boards
