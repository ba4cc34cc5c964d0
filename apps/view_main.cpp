// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight view and fly --view. Separate, because its server takes long to compile.
#include <string_view>

#include "apps/fly_command.hpp"
#include "apps/fly_command_line.hpp"
#include "apps/options.hpp"
#include "apps/vehicle_view.hpp"
#include "flight/build_info.hpp"

namespace {

namespace apps = rosflight::apps;

int view_command_line(int argc, char** argv) {
  CLI::App app{"rosflight: view. ./rosflight --help lists all commands."};
  apps::ViewOptions options;
  CLI::App* view = app.add_subcommand(
      "view",
      "Shows a flight, or a vehicle on a link, in the browser; to this computer alone unless "
      "--listen");
  view->add_option("INPUT", options.input,
                   "Flight folder, log (.mcap), or link to a vehicle as in docs/ground-tools.md: "
                   "serial:PATH[:BAUD], /dev/..., udp:PORT, udp:HOST:PORT, tcp:HOST:PORT")
      ->required();
  view->add_option("--out", options.folder,
                   "Of a link: folder for its log, new or empty; default: next in flights/");
  view->add_option("--port", options.access.port, "Of the address to open; 0: a free one")
      ->capture_default_str();
  view->add_option(
      "--listen", options.access.listen,
      "Address of a network interface: serve other computers too, by a secret address");
  app.set_version_flag("--version", rosflight::flight::build_info_text());
  return apps::parse_and_run(app, argc, argv, [&options] {
    return apps::is_link(options.input.string()) ? apps::view_vehicle(options, std::cout)
                                                 : apps::view_command(options, std::cout);
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "fly") {
    return apps::fly_command_line(argc, argv,
                                  [](const rosflight::web::server::Access& access, bool hold) {
                                    return apps::watch_flight(access, hold, std::cerr);
                                  });
  }
  return view_command_line(argc, argv);
}
