// SPDX-License-Identifier: BSD-3-Clause
// `./rosflight sil` with the echo of echo_main.hpp, for measuring round trips.
//
//     sil_echo sil [SIL_OPTION...]
#include "apps/tools_command_line.hpp"
#include "firmware/boards/common/echo_main.hpp"

namespace {

struct Echo {
  std::shared_ptr<rosflight::link::Codec> inner;
  rosflight::boards::EchoCodec codec;
};

}  // namespace

int main(int argc, char** argv) {
  using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file
  return apps::tools_command_line(argc, argv, [](hal::Serial& port) {
    const auto inner = flight::LinuxAutopilot::mavlink(port);
    const auto echo = std::make_shared<Echo>(Echo{inner, {*inner, port}});
    return std::shared_ptr<link::Codec>(echo, &echo->codec);
  });
}
