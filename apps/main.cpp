// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight: reads the command line, runs one command, turns errors into one
// line.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "apps/fly/fly_command.hpp"
#include "apps/link_protocol.hpp"
#include "apps/mixer/mixer_command.hpp"
#include "apps/options.hpp"
#include "apps/project_root.hpp"
#include "apps/replay/replay.hpp"
#include "apps/sil/sil_cli.hpp"
#include "apps/trim/trim_command.hpp"

namespace {

using namespace rosflight::apps;  // NOLINT(google-build-using-namespace): this is their main

constexpr int kBadInput = 2;

CLI::App* add_fly(CLI::App& app, FlyOptions& options) {
  CLI::App* fly = app.add_subcommand("fly", "Fly a mission in simulation; leaves a flight folder");
  FlightChoice& choice = options.choice;
  fly->add_option("--vehicle", choice.vehicle, "Vehicle: a name of vehicles/ or a YAML file")
      ->capture_default_str();
  fly->add_option("--board", choice.board,
                  "Where the firmware runs: in_process, or qemu_m7, an emulated Cortex-M7")
      ->capture_default_str()
      ->check(CLI::IsMember({"in_process", "qemu_m7"}));
  fly->add_option("--link", choice.link,
                  "cable: the simulated one; uart: the emulated board's, in real time")
      ->capture_default_str()
      ->check(CLI::IsMember({"cable", "uart"}));
  fly->add_option("--mission", choice.mission, "Mission: a name of missions/ or a YAML file")
      ->capture_default_str();
  fly->add_option("--seed", choice.seed, "Seed of all noise and wind; same seed, same bits")
      ->check(whole_number)
      ->capture_default_str();
  fly->add_option("--state", choice.state,
                  "Where guidance gets its state from: estimate (filter on the link's sensor "
                  "streams) or truth")
      ->capture_default_str()
      ->check(CLI::IsMember({"estimate", "truth"}));
  fly->add_option("--link-protocol", choice.link_protocol,
                  "What the board speaks: mavlink or lean; the companion finds out")
      ->capture_default_str()
      ->check(CLI::IsMember(link_protocols()));
  fly->add_option("--wind", choice.wind,
                  "SPEED,FROM_DEG[,W20]: steady wind and Dryden turbulence [m/s]");
  fly->add_option("--set", choice.overrides, "vehicle.key=value, e.g. vehicle.body.mass_kg=3.2")
      ->take_all();
  fly->add_option("--fault", choice.faults,
                  "WHAT@TIME[:DURATION], seconds since power-up. WHAT is one of\n" +
                      rosflight::sim::fault_help())
      ->take_all();
  fly->add_option("--plugin", choice.plugins,
                  "Shared library with modules of your own (examples/custom_drag)")
      ->take_all();
  fly->add_option("--visualiser", choice.visualisers,
                  "Visualiser of a plugin, by name; sees the flight beside the log")
      ->take_all();
  fly->add_flag("--realtime", options.realtime, "At the pace of the wall clock");
  fly->add_option("--out", options.out, "Flight folder, new or empty; default: next in flights/");
  fly->add_flag("--json", options.json, "Print the summary as one JSON object");
  return fly;
}

CLI::App* add_replay(CLI::App& app, ReplayOptions& options) {
  CLI::App* replay = app.add_subcommand("replay", "Feed recorded inputs to the firmware");
  replay->add_option("INPUT", options.input, "CSV file (docs/replay.md)")->required();
  replay->add_option("--params", options.params, "Parameters set before the first row, CSV");
  replay->add_option("-o,--output", options.output, "Write what came out to this CSV file");
  replay->add_flag("--force", options.force, "Replace an existing output file");
  replay->add_flag("--compare", options.compare, "Compare with the output columns of INPUT");
  replay->add_option("--except", options.waivers, "Differences that are meant, CSV");
  return replay;
}

CLI::App* add_mixer(CLI::App& app, MixerOptions& options) {
  CLI::App* mixer =
      app.add_subcommand("mixer", "Make custom-mixer parameters from a frame's geometry");
  mixer->add_option("-f,--param-file", options.input, "Frame file (docs/mixer.md)")->required();
  mixer->add_option("-o,--output-file", options.output, "Parameter file to write")
      ->capture_default_str();
  const std::map<std::string, MixerTarget> kTargets{{"PRI", MixerTarget::kPrimary},
                                                    {"SEC", MixerTarget::kSecondary}};
  mixer->add_option("-t,--output-mixer-type", options.target, "PRI or SEC")
      ->transform(CLI::CheckedTransformer(kTargets, CLI::ignore_case));
  mixer->add_flag("-a,--append-output", options.append, "Add to an existing parameter file");
  mixer->add_flag("--force", options.force, "Replace an existing file");
  return mixer;
}

CLI::App* add_trim(CLI::App& app, TrimOptions& options) {
  CLI::App* trim = app.add_subcommand("trim", "Trim a fixed wing; print state, outputs and modes");
  trim->add_option("--vehicle", options.vehicle, "Fixed wing: a name of vehicles/ or a YAML file")
      ->capture_default_str();
  trim->add_option("--speed", options.speed_m_s, "Airspeed [m/s]")->required();
  trim->add_option("--radius", options.radius_m, "Turn radius [m], to the right positive");
  trim->add_option("--climb", options.climb_deg, "Angle of the path above the horizon [deg]");
  trim->add_option("--height", options.height_m, "Above the vehicle's origin [m]");
  trim->add_option("--set", options.overrides, "vehicle.key=value, e.g. vehicle.body.mass_kg=5")
      ->take_all();
  return trim;
}

int run(int argc, char** argv) {
  CLI::App app{
      "rosflight: fly, replay, sil, mixer and trim. ./rosflight --help lists all commands."};
  app.name("./rosflight");
  app.require_subcommand(1);
  FlyOptions fly_options;
  ReplayOptions replay_options;
  MixerOptions mixer_options;
  SilOptions sil_options;
  TrimOptions trim_options;
  const CLI::App* fly = add_fly(app, fly_options);
  const CLI::App* replay_app = add_replay(app, replay_options);
  const CLI::App* mixer = add_mixer(app, mixer_options);
  const CLI::App* sil = add_sil(app, sil_options);
  const CLI::App* trim = add_trim(app, trim_options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::cerr << "rosflight: " << e.what() << " (--help lists what is allowed)\n";
    return kBadInput;
  }
  if (*fly) return fly_command(fly_options, std::cout, std::cerr);
  if (*replay_app) return replay(replay_options, std::cout);
  if (*mixer) return mixer_command(mixer_options, std::cout);
  if (*trim) return trim_command(trim_options, std::cout);
  if (*sil) {
    sil_options.vehicles_folder = project_root() / "vehicles";
    return sil_command(sil_options, std::cout);
  }
  return kBadInput;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << "rosflight: " << e.what() << "\n";
    return kBadInput;
  }
}
