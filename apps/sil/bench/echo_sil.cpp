// SPDX-License-Identifier: BSD-3-Clause
// `./rosflight sil` with the echo of echo_codec.hpp, for measuring round trips.
//
//     sil_echo sil [SIL_OPTION...]
#include <CLI/CLI.hpp>
#include <iostream>

#include "apps/project_root.hpp"
#include "apps/sil/bench/echo_codec.hpp"
#include "apps/sil/sil_cli.hpp"

int main(int argc, char** argv) {
  using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file
  try {
    CLI::App app{"sil with an echo of offboard commands"};
    apps::SilOptions options;
    app.require_subcommand(1);
    apps::add_sil(app, options);
    CLI11_PARSE(app, argc, argv);
    options.vehicles_folder = apps::project_root() / "vehicles";
    return apps::sil_command(options, std::cout, [](hal::Serial& port) {
      return std::make_shared<apps::EchoCodec>(apps::SilBoard::mavlink(port), port);
    });
  } catch (const std::exception& error) {
    std::cerr << "sil_echo: " << error.what() << "\n";
    return 2;
  }
}
