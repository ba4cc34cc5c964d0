// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly_command_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>

#include "apps/campaign_command.hpp"
#include "apps/fly_command.hpp"
#include "apps/fly_viewer.hpp"
#include "apps/options.hpp"
#include "apps/viewers.hpp"
#include "flight/build_info.hpp"
#include "flight/link_protocol.hpp"
#include "sim/faults.hpp"

namespace rosflight::apps {
namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): what the command calls

/// What --view asks for.
struct ViewChoice {
  bool view{false};
  bool hold{false};
  web::server::Access access;
};

void add_view(CLI::App& fly, FlyOptions& options, ViewChoice& choice) {
  fly.add_flag("--view", choice.view,
               "Show it in the browser while it flies, in real time, and until Ctrl-C");
  fly.add_option("--port", choice.access.port, "With --view: of the address to open; 0: a free one")
      ->capture_default_str();
  fly.add_option("--listen", choice.access.listen,
                 "With --view: address of a network interface, for other computers");
  fly.add_option("--allow-origin", choice.access.origins,
                 "With --view: origin of a page, such as https://example.org, that may look beside "
                 "Foxglove and Lichtblick; may be repeated")
      ->allow_extra_args(false);
  fly.add_flag("--hold", choice.hold,
               "With --view: the pilot does not arm by himself, a viewer does");
  constexpr double kMinSpeed = 0.01;
  constexpr double kMaxSpeed = 100.0;
  fly.add_option_function<double>(
         "--speed",
         [&options](double speed) {
           options.speed = speed;
           options.realtime = true;
         },
         "Speed relative to real time")
      ->check(CLI::Range(kMinSpeed, kMaxSpeed));
}

/// For CLI11: empty if `text` may be part of the names of shared memory.
std::string engine_name(const std::string& text) {
  const bool plain = std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  return plain && !text.empty() ? std::string()
                                : "found '" + text + "', allowed letters, digits, _ and -";
}

void add_viewer(CLI::App& fly, ViewerChoice& choice) {
  constexpr double kMinTimeout_s = 0.1;
  constexpr double kMaxTimeout_s = 3600.0;
  CLI::Option* viewer =
      fly.add_option(
             "--viewer", choice.viewer,
             "Show it in a world of others: holoocean, which must be installed; the flight is the "
             "same to the bit")
          ->check(one_of({ViewerChoice::kHoloOcean}));
  fly.add_option(
         "--viewer-scenario", choice.scenario,
         "With --viewer: scenario file of HoloOcean (JSON); default: package Land, no camera")
      ->needs(viewer);
  fly.add_option("--viewer-engine", choice.engine,
                 "With --viewer: program of the world, or attach: to a running engine; default: "
                 "the installed one")
      ->needs(viewer);
  fly.add_option("--viewer-name", choice.name,
                 "With --viewer: name of the engine's shared memory; default: a new one")
      ->needs(viewer)
      ->check(engine_name);
  fly.add_option("--viewer-timeout", choice.timeout_s,
                 "With --viewer: seconds without an answer after which the flight goes on without "
                 "it; default: 30 to load, 60 in flight")
      ->needs(viewer)
      ->check(CLI::Range(kMinTimeout_s, kMaxTimeout_s));
  fly.add_flag("--viewer-offscreen", choice.offscreen,
               "With --viewer: no window, only what the cameras of the scenario see")
      ->needs(viewer);
}

CLI::App* add_fly(CLI::App& app, FlyOptions& options, bool& json,
                  std::optional<std::string>& seeds) {
  CLI::App* fly = app.add_subcommand("fly", "Fly a mission in simulation; leaves a flight folder");
  FlightChoice& choice = options.choice;
  fly->add_option("--vehicle", choice.vehicle, "Vehicle: a name of vehicles/ or a YAML file")
      ->capture_default_str();
  std::vector<std::string> boards{"in_process", "qemu_m7"};
  boards.insert(boards.end(), kChipBoards.begin(), kChipBoards.end());
  fly->add_option("--board", choice.board,
                  fmt::format("Where the firmware runs: in_process; qemu_m7, an emulated "
                              "Cortex-M7; {}: the image of that board on an emulated STM32H7",
                              fmt::join(kChipBoards, ", ")))
      ->capture_default_str()
      ->check(one_of(boards));
  fly->add_option("--link", choice.link,
                  "cable: the simulated one; uart: that of qemu_m7, in real time; usb: that of an "
                  "emulated STM32H7")
      ->capture_default_str()
      ->check(one_of({"cable", "uart", "usb"}));
  fly->add_option("--mission", choice.mission, "Mission: a name of missions/ or a YAML file")
      ->capture_default_str();
  fly->add_option("--seed", choice.seed, "Seed of all noise and wind; same seed, same bits")
      ->check(whole_number)
      ->capture_default_str();
  fly->add_option("--state", choice.state,
                  "Where guidance gets its state from: estimate (filter on the link's sensor "
                  "streams) or truth")
      ->capture_default_str()
      ->check(one_of({"estimate", "truth"}));
  fly->add_option(
         "--pilot", choice.pilot,
         "Throttle stick of the safety pilot, who does not see the vehicle, from 1 s after "
         "arming to disarming: hover (carries the vehicle) or idle")
      ->capture_default_str()
      ->check(one_of({"hover", "idle"}));
  fly->add_option("--physics", choice.physics,
                  "What moves the body: runge_kutta; runge_kutta_held, the same with the load held "
                  "over each step, as any other engine gets it; jsbsim and gazebo, each in a "
                  "process of its own")
      ->capture_default_str()
      ->check(one_of(std::vector<std::string>(kPhysics.begin(), kPhysics.end())));
  fly->add_option(
      "--world", choice.world,
      "SDF file with terrain, buildings and obstacles: what world_sensors of the vehicle "
      "file measure, and with --physics gazebo the ground in place of the flat one");
  fly->add_option("--link-protocol", choice.link_protocol,
                  "Protocol of the board: mavlink or lean; the companion detects it")
      ->capture_default_str()
      ->check(one_of(link_protocols()));
  fly->add_option("--wind", choice.wind,
                  "SPEED,FROM_DEG[,W20]: steady wind and Dryden turbulence [m/s]");
  fly->add_option("--set", choice.overrides, "vehicle.key=value, e.g. vehicle.body.mass_kg=3.2")
      ->take_all();
  fly->add_option(
         "--fault", choice.faults,
         "WHAT@TIME[:DURATION], seconds since power-up. WHAT is one of\n" + sim::fault_help())
      ->take_all();
  fly->add_option("--plugin", choice.plugins,
                  "Shared library with modules of your own (examples/custom_drag)")
      ->take_all();
  fly->add_option("--visualiser", choice.visualisers,
                  "Visualiser of a plugin, by name; sees the flight beside the log")
      ->take_all();
  fly->add_flag("--realtime", options.realtime, "In real time");
  fly->add_option("--out", options.folder,
                  "Flight folder, new or empty; default: next in flights/. With --seeds: CSV file");
  fly->add_option(
      "--seeds", seeds,
      "FIRST:LAST: one flight per seed, on all processors, without logs; a row of --out "
      "each");
  CLI::Option* log =
      fly->add_option("--log", options.log,
                      "plot: sensors and link complete, truth, attitude and outputs at 100 Hz; "
                      "full: every step; none")
          ->capture_default_str()
          ->check(one_of({"plot", "full", "none"}));
  fly->add_flag_callback(
         "--no-log", [&options] { options.log = "none"; }, "The same as --log none")
      ->excludes(log);
  fly->add_flag("--json", json, "Print the summary as one JSON object");
  return fly;
}

/// Options that say nothing about many flights.
void check_campaign(const CLI::App& fly, const FlyOptions& options) {
  for (const char* name : {"--seed", "--realtime", "--speed", "--view", "--viewer", "--json",
                           "--visualiser", "--repeat"}) {
    if (fly.count(name) > 0)
      throw config::Error(std::string(name) + ": found with --seeds, allowed with one flight");
  }
  if (fly.count("--log") > 0 && options.log != "none")
    throw config::Error("--log: found " + options.log + " with --seeds, allowed none");
  if (!options.folder) throw config::Error("--out: found nothing, allowed a CSV file with --seeds");
}

/// Nothing without --view. A flight that is watched is at the pace of the wall clock.
std::unique_ptr<viewer::FlightWatch> watch_of(const ViewChoice& choice, const Viewers* viewers,
                                              FlyOptions& options) {
  if (!choice.view) return nullptr;
  if (options.log == "none")
    throw config::Error(
        "--log: found none with --view, allowed plot, full: it shows what is logged");
  if (viewers == nullptr)
    throw config::Error("--view: found in a program without it; use ./rosflight fly");
  options.realtime = true;
  return viewers->watch(choice.access, choice.hold);
}

/// Flies what a log has again, with all that was changed by hand. @returns 0 if the log is equal.
int repeat_command(const CLI::App& fly, const std::string& log, const Viewers* viewers,
                   FlyOptions options, bool json) {
  if (viewers == nullptr)
    throw config::Error("--repeat: found in a program without it; use ./rosflight fly");
  for (const char* name : {"--vehicle", "--mission", "--seed", "--state", "--pilot", "--wind",
                           "--set", "--fault", "--plugin", "--link", "--link-protocol", "--physics",
                           "--world", "--log", "--no-log", "--view", "--viewer", "--visualiser"}) {
    if (fly.count(name) > 0)
      throw config::Error(std::string(name) + ": found with --repeat, which takes it from the log");
  }
  const RecordedFlight recorded = read_recorded_flight(log);
  const std::string board = options.choice.board;
  options.choice = recorded.choice;
  options.choice.board = board;
  options.log = recorded.log;
  const auto commander = viewers->repeat(recorded);
  options.commander = commander.get();
  std::string sha256;
  const int code = fly_command(options, json, std::cout, std::cerr, nullptr, &sha256);
  if (code > 1) return code;  // a signal
  const bool equal = sha256 == recorded.sha256;
  std::cerr << "rosflight: " << recorded.commands.size() << " commands repeated; the log "
            << (equal ? "is equal to the bit"
                      : "differs: " + sha256 + " instead of " + recorded.sha256)
            << std::endl;
  return equal ? 0 : 1;
}

}  // namespace

int fly_command_line(int argc, char** argv, const Viewers* viewers) {
  CLI::App app{"rosflight: fly. ./rosflight --help lists all commands."};
  FlyOptions options;
  bool json = false;
  std::optional<std::string> seeds;
  options.arguments.assign(argv + 1, argv + argc);
  CLI::App* fly = add_fly(app, options, json, seeds);
  ViewChoice view;
  add_view(*fly, options, view);
  ViewerChoice viewer;
  add_viewer(*fly, viewer);
  std::optional<std::string> repeat;
  fly->add_option("--repeat", repeat,
                  "Log or flight folder: flies it again with all that viewers changed; exit code 0 "
                  "if the logs are equal to the bit");
  app.set_version_flag("--version", build_info_text());
  return parse_and_run(app, argc, argv, [&] {
    if (repeat && !seeds) return repeat_command(*fly, *repeat, viewers, options, json);
    if (!seeds) {
      const auto watch = watch_of(view, viewers, options);
      std::optional<FlyViewer> world;
      if (!viewer.viewer.empty()) world.emplace(viewer, options, std::cerr);
      if (world && world->stop_signal() != 0) return 128 + world->stop_signal();
      return fly_command(options, json, std::cout, std::cerr, watch.get());
    }
    check_campaign(*fly, options);
    return campaign_command(options.choice, *seeds, *options.folder, std::cout, std::cerr);
  });
}

}  // namespace rosflight::apps
