// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight view, fly --view and fly --repeat. Separate, because a server and what its viewers command
// take long to compile.
#include <filesystem>
#include <memory>
#include <string_view>

#include "apps/fly_command.hpp"
#include "apps/fly_command_line.hpp"
#include "apps/options.hpp"
#include "apps/viewers.hpp"
#include "config/strict_yaml.hpp"
#include "flight/build_info.hpp"
#include "viewer/flight_commander.hpp"
#include "viewer/flight_watch.hpp"
#include "viewer/log_view.hpp"
#include "viewer/vehicle_view.hpp"

namespace {

namespace apps = rosflight::apps;
namespace viewer = rosflight::viewer;

int view_command_line(int argc, char** argv) {
  CLI::App app{"rosflight: view. ./rosflight --help lists all commands."};
  std::filesystem::path input;
  viewer::VehicleViewOptions options;
  CLI::App* view = app.add_subcommand(
      "view",
      "Shows a flight, or a vehicle on a link, in the browser; to this computer alone unless "
      "--listen");
  view->add_option("INPUT", input,
                   "Flight folder, log (.mcap), or link to a vehicle as in docs/ground-tools.md: "
                   "serial:PATH[:BAUD], /dev/..., udp:PORT, udp:HOST:PORT, tcp:HOST:PORT")
      ->required();
  view->add_option("--out", options.folder,
                   "Of a link: folder for its log, new or empty; default: next in flights/");
  view->add_option("--compare", options.compare,
                   "With a link: link to another vehicle, whose parameters are compared with");
  view->add_option("--port", options.access.port, "Of the address to open; 0: a free one")
      ->capture_default_str();
  view->add_option(
      "--listen", options.access.listen,
      "Address of a network interface: serve other computers too, by a secret address");
  view->add_option("--allow-origin", options.access.origins,
                   "Origin of a page, such as https://example.org, that may look beside Foxglove "
                   "and Lichtblick; may be repeated")
      ->allow_extra_args(false);
  app.set_version_flag("--version", rosflight::flight::build_info_text());
  return apps::parse_and_run(app, argc, argv, [&] {
    options.link = input.string();
    if (viewer::is_link(options.link)) return viewer::view_vehicle(options, std::cout);
    if (!options.compare.empty()) {
      throw rosflight::config::Error("--compare: found " + options.compare + " with " +
                                     options.link + ", allowed with a link to a vehicle");
    }
    return viewer::view_log(input, options.access, std::cout);
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "fly") {
    apps::Viewers viewers;
    viewers.watch = [](const rosflight::web::server::Access& access, bool hold) {
      return viewer::watch_flight(access, hold, std::cerr);
    };
    viewers.repeat = [](const rosflight::flight::RecordedFlight& recorded) {
      return std::make_unique<viewer::RepeatCommander>(recorded);
    };
    return apps::fly_command_line(argc, argv, &viewers);
  }
  return view_command_line(argc, argv);
}
