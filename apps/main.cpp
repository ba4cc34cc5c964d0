// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight. It flies; the other commands are in programs beside it, so that the first flight of a
// new clone need not wait for their compilers.
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

struct Elsewhere {
  std::string_view command;
  const char* program;
};
constexpr const char* kTools = "rosflight_tools";
constexpr const char* kGround = "rosflight_ground_tools";
constexpr const char* kView = "rosflight_view";
constexpr std::array<Elsewhere, 11> kElsewhere{{{"replay", kTools},
                                                {"sil", kTools},
                                                {"mixer", kTools},
                                                {"trim", kTools},
                                                {"sdf", kTools},
                                                {"params", kGround},
                                                {"calibrate", kGround},
                                                {"monitor", kGround},
                                                {"preflight", kGround},
                                                {"blackbox", kGround},
                                                {"view", kView}}};

/// Goes on as that program with the same arguments. Comes back only when that is not possible.
int run(const char* program, char** argv) {
  std::error_code ignored;  // then the working directory is looked in, and the message names it
  const std::filesystem::path tools =
      std::filesystem::read_symlink("/proc/self/exe", ignored).replace_filename(program);
  // NOLINTNEXTLINE(clang-analyzer-optin.taint.GenericTaint): the user's arguments, for our program
  ::execv(tools.c_str(), argv);
  std::cerr << "rosflight: " << argv[1] << " needs " << tools.string() << ": "
            << std::strerror(errno) << " (./rosflight " << argv[1] << " builds it)\n";
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view command = argc > 1 ? argv[1] : "";
  const auto has_viewers = [](std::string_view word) {
    return word == "--view" || word == "--repeat" || word.rfind("--repeat=", 0) == 0;
  };
  if (command == "fly" && std::any_of(argv + 2, argv + argc, has_viewers)) return run(kView, argv);
  const auto* const there =
      std::find_if(kElsewhere.begin(), kElsewhere.end(),
                   [command](const Elsewhere& e) { return e.command == command; });
  return there != kElsewhere.end() ? run(there->program, argv)
                                   : rosflight::apps::fly_command_line(argc, argv);
}
