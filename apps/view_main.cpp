// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight view. Separate, because its server takes long to compile.
#include "apps/options.hpp"
#include "apps/view_command.hpp"
#include "flight/build_info.hpp"

int main(int argc, char** argv) {
  using namespace rosflight;  // NOLINT(google-build-using-namespace): the program itself
  CLI::App app{"rosflight: view. ./rosflight --help lists all commands."};
  apps::ViewOptions options;
  CLI::App* view = app.add_subcommand(
      "view", "Shows a flight in the browser: 3-D, plots, events; serves this computer alone");
  view->add_option("INPUT", options.input, "Flight folder, or log (.mcap)")->required();
  view->add_option("--port", options.port, "Of the address to open; 0: a free one")
      ->capture_default_str();
  app.set_version_flag("--version", flight::build_info_text());
  return apps::parse_and_run(app, argc, argv,
                             [&options] { return apps::view_command(options, std::cout); });
}
