// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight. It flies; the other commands are in rosflight_tools beside it, so that the first flight
// of a new clone need not wait for their compilers.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string_view>
#include <system_error>

#include "apps/fly_command_line.hpp"

namespace {

constexpr std::array<std::string_view, 4> kTools{"replay", "sil", "mixer", "trim"};

/// Goes on as rosflight_tools with the same arguments. Comes back only when that is not possible.
int run_tools(char** argv) {
  std::error_code ignored;  // then the working directory is looked in, and the message says so
  const std::filesystem::path tools =
      std::filesystem::read_symlink("/proc/self/exe", ignored).replace_filename("rosflight_tools");
  ::execv(tools.c_str(), argv);
  std::cerr << "rosflight: " << argv[1] << " needs " << tools.string() << ": "
            << std::strerror(errno) << " (./rosflight " << argv[1] << " builds it)\n";
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_tool = argc > 1 && std::find(kTools.begin(), kTools.end(), argv[1]) != kTools.end();
  return is_tool ? run_tools(argv) : rosflight::apps::fly_command_line(argc, argv);
}
