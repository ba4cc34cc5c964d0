// SPDX-License-Identifier: BSD-3-Clause
#include "apps/tools_command_line.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "apps/mixer_command.hpp"
#include "apps/options.hpp"
#include "apps/sdf_command.hpp"
#include "apps/trim_command.hpp"
#include "flight/build_info.hpp"
#include "flight/link_protocol.hpp"
#include "flight/project_root.hpp"
#include "flight/replay/flight_replay.hpp"
#include "flight/replay/replay.hpp"
#include "flight/sil/sil.hpp"
#include "sim/faults.hpp"

namespace rosflight::apps {
namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): what the commands call

CLI::App* add_replay(CLI::App& app, ReplayOptions& options) {
  CLI::App* replay = app.add_subcommand("replay", "Feed recorded inputs to the firmware again");
  replay
      ->add_option("INPUT", options.input,
                   "Flight folder or log (.mcap) of fly --log full, compared to the bit; or CSV "
                   "file (docs/replay.md), whose options follow")
      ->required();
  replay->add_option("--params", options.params, "Parameters set before the first row, CSV");
  replay->add_option("-o,--output", options.output, "Write what came out to this CSV file");
  replay->add_flag("--force", options.force, "Replace an existing output file");
  replay->add_flag("--compare", options.compare, "Compare with the output columns of INPUT");
  replay->add_option("--except", options.waivers, "Differences that are meant, CSV");
  return replay;
}

bool is_flight(const std::filesystem::path& input) {
  return std::filesystem::is_directory(input) || input.extension() == ".mcap";
}

int replay_command(const ReplayOptions& options) {
  if (!is_flight(options.input)) return replay(options, std::cout);
  if (options.params || options.output || options.force || options.compare || options.waivers) {
    throw InputError(options.input +
                     ": is a flight, found an option; allowed with a CSV file only");
  }
  return replay_flight(options.input, std::cout);
}

CLI::App* add_mixer(CLI::App& app, MixerOptions& options) {
  CLI::App* mixer =
      app.add_subcommand("mixer", "Make a custom mixer from the geometry of a multirotor");
  CLI::Option* vehicle = mixer->add_option("--vehicle", options.vehicle,
                                           "Multirotor: a name of vehicles/ or a YAML file");
  mixer->add_option("-f,--param-file", options.input, "Frame file of ROSflight 2.x (docs/mixer.md)")
      ->excludes(vehicle);
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

CLI::App* add_sdf(CLI::App& app, SdfOptions& options) {
  CLI::App* sdf = app.add_subcommand(
      "sdf", "Write a vehicle as a model for Gazebo and others (SDF 1.9), with joints to look at");
  sdf->add_option("VEHICLE", options.vehicle, "A name of vehicles/ or a YAML file")->required();
  sdf->add_option("-o,--output", options.output, "File to write; default: standard output");
  sdf->add_option("--world", options.world,
                  "A world that flies in this release of Gazebo, with ground and plugin")
      ->check(CLI::IsMember(std::vector<std::string>{"fortress", "harmonic", "jetty"}));
  sdf->add_option("--plugin", options.plugin,
                  "NAME=VALUE, an element of the plugin, e.g. mode=whole_loop; with --world")
      ->take_all();
  sdf->add_flag("--force", options.force, "Replace an existing file");
  sdf->add_option("--set", options.overrides, "vehicle.key=value, e.g. vehicle.body.mass_kg=5")
      ->take_all();
  return sdf;
}

CLI::App* add_sil(CLI::App& app, SilOptions& options) {
  CLI::App* sil = app.add_subcommand(
      "sil", "Run the firmware as a process in real time, its serial port on a pty, UDP or TCP");
  sil->add_option("--vehicle", options.vehicle, "Name of a vehicle, or a vehicle file")
      ->capture_default_str();
  sil->add_option("--set", options.overrides, "vehicle.section.key=value, may be repeated")
      ->type_name("ASSIGNMENT")
      ->allow_extra_args(false);
  sil->add_option("--plugin", options.plugins, "Shared library with modules of your own")
      ->type_name("FILE")
      ->allow_extra_args(false);
  sil->add_option("--link", options.link,
                  "Serial port: pty[:PATH], udp:HOST:PORT, tcp:PORT or tcp:HOST:PORT; tcp:PORT "
                  "listens on 127.0.0.1 only")
      ->type_name("ADDRESS")
      ->capture_default_str();
  sil->add_option("--listen", options.listen,
                  "Own port of a UDP link [14525 if the far end is 14520, otherwise any free one]")
      ->type_name("PORT");
  sil->add_option("--link-protocol", options.link_protocol,
                  "Protocol of the board: mavlink or lean; ground tools of ROSflight need mavlink")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(one_of(link_protocols()));
  sil->add_option("--nvm", options.storage,
                  "File that keeps the parameters; created if missing [rosflight_VEHICLE.nvm]")
      ->type_name("FILE");
  sil->add_option("--rate", options.rate_Hz, "IMU samples and simulation steps per second")
      ->check(CLI::Range(SilOptions::kMinRate_Hz, SilOptions::kMaxRate_Hz))
      ->capture_default_str();
  sil->add_option("--rc", options.rc,
                  "Script of the pilot (YAML), or - for lines of standard input as \"roll 0.5\"; "
                  "default: sticks centred, throttle low")
      ->type_name("FILE");
  sil->add_option("--duration", options.duration_s, "End after this time")
      ->type_name("S")
      ->check(CLI::PositiveNumber);
  sil->add_option("--fault", options.faults, "Fault, may be repeated; see below")
      ->type_name("WHAT@TIME[:DURATION]")
      ->allow_extra_args(false);
  sil->add_option("--seed", options.seed, "Seed of all noise")
      ->check(whole_number)
      ->capture_default_str();
  sil->footer("Faults, times in seconds:\n" + sim::fault_help());
  return sil;
}

}  // namespace

int tools_command_line(int argc, char** argv, flight::LinuxAutopilot::MakeCodec sil_codec) {
  CLI::App app{
      "rosflight: replay, sil, mixer, trim and sdf. ./rosflight --help lists all commands."};
  ReplayOptions replay_options;
  MixerOptions mixer_options;
  SilOptions sil_options;
  TrimOptions trim_options;
  SdfOptions sdf_options;
  const CLI::App* replay_app = add_replay(app, replay_options);
  const CLI::App* mixer = add_mixer(app, mixer_options);
  const CLI::App* trim = add_trim(app, trim_options);
  const CLI::App* sdf = add_sdf(app, sdf_options);
  add_sil(app, sil_options);
  app.set_version_flag("--version", build_info_text());
  return parse_and_run(app, argc, argv, [&] {
    if (*replay_app) return replay_command(replay_options);
    if (*mixer) return mixer_command(mixer_options, std::cout);
    if (*trim) return trim_command(trim_options, std::cout);
    if (*sdf) return sdf_command(sdf_options, std::cout);
    sil_options.vehicles_folder = project_root() / "vehicles";
    return sil_command(sil_options, std::cout, std::move(sil_codec));
  });
}

}  // namespace rosflight::apps
