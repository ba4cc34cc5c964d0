// SPDX-License-Identifier: BSD-3-Clause
// `./rosflight sil` with the echo of echo_codec.hpp, for measuring round trips.
//
//     sil_echo sil [SIL_OPTION...]
#include "apps/measure/echo_codec.hpp"
#include "apps/tools_command_line.hpp"

int main(int argc, char** argv) {
  using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file
  return apps::tools_command_line(argc, argv, [](hal::Serial& port) {
    return std::make_shared<flight::EchoCodec>(flight::LinuxAutopilot::mavlink(port), port);
  });
}
