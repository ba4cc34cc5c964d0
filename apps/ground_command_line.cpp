// SPDX-License-Identifier: BSD-3-Clause
#include "apps/ground_command_line.hpp"

#include <unistd.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "apps/options.hpp"
#include "base/stop_signal.hpp"
#include "config/strict_yaml.hpp"
#include "ground/blackbox.hpp"
#include "ground/calibration.hpp"
#include "ground/monitor.hpp"
#include "ground/parameter_commands.hpp"
#include "ground/preflight.hpp"

namespace rosflight::apps {
namespace {

using namespace rosflight::ground;  // NOLINT(google-build-using-namespace): what the commands call

/// What to do with a connected link.
using Action = std::function<int(GroundLink&)>;

struct LinkChoice {
  std::string link;
  double timeout_s{5.0};
  int system{1};
};

void add_link(CLI::App& app, LinkChoice& choice) {
  app.add_option(
         "LINK", choice.link,
         "serial:PATH[:BAUD], PATH[:BAUD], udp:HOST:PORT[:LOCAL_PORT], udp:PORT, tcp:HOST:PORT "
         "or tcp:PORT; also what ./rosflight sil prints as link=")
      ->required();
  app.add_option("--timeout", choice.timeout_s, "Wait so long for an answer of the vehicle [s]")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  app.add_option("--system", choice.system, "SYS_ID of the vehicle")
      ->check(CLI::Range(1, 255))
      ->capture_default_str();
}

struct ParamsOptions {
  std::vector<std::string> names;
  std::vector<std::string> assignments;
  std::string file;
  bool json{false};
  bool write{false};
  bool changed{false};
  bool all{false};
  bool force{false};
};

/// The help of `params` holds that of its actions, which `./rosflight` prints without a build.
CLI::App* add_params(CLI::App& app, LinkChoice& choice, ParamsOptions& o) {
  CLI::App* params =
      app.add_subcommand("params", "Parameters of a vehicle: list, get, set, load, save, compare");
  params->set_help_flag();
  params->set_help_all_flag("-h,--help", "Print this help message and exit");
  add_link(*params, choice);
  params->require_subcommand(1);
  params->fallthrough();  // --timeout may stand after the action too
  CLI::App* list =
      params->add_subcommand("list", "Name, value, default and unit of each; * differs");
  CLI::App* get = params->add_subcommand("get", "Values of some parameters");
  CLI::App* set =
      params->add_subcommand("set", "Set values; the answer of the vehicle is read back");
  CLI::App* load = params->add_subcommand("load", "Set all values of a parameter file");
  CLI::App* save = params->add_subcommand("save", "Write all parameters to a file");
  CLI::App* diff =
      params->add_subcommand("diff", "Compare with a file; exit code 1 if values differ");
  get->add_option("NAME", o.names, "Names")->required();
  set->add_option("NAME VALUE", o.assignments, "Names and values in turn")->required();
  for (CLI::App* with_file : {load, save, diff}) {
    with_file->add_option("FILE", o.file, "Parameter file as ROSflight 2.x has them")->required();
  }
  for (CLI::App* with_json : {list, get, diff}) with_json->add_flag("--json", o.json, "Print JSON");
  for (CLI::App* writing : {set, load}) {
    writing->add_flag("--write", o.write,
                      "Store all parameters in the vehicle's memory afterwards");
  }
  list->add_flag("--changed", o.changed, "Only those that differ from their defaults");
  save->add_flag("--changed", o.changed, "Only those that differ from their defaults");
  save->add_flag("--force", o.force, "Replace an existing file");
  diff->add_flag("--all", o.all, "Also the parameters that the file does not have");
  return params;
}

/// Checks what needs no vehicle.
Action params_action(const CLI::App& params, const ParamsOptions& o) {
  const auto chosen = [&params](const char* name) { return params.got_subcommand(name); };
  if (chosen("list")) {
    return [&o](GroundLink& l) { return list_parameters(l, o.changed, o.json, std::cout); };
  }
  if (chosen("get")) {
    return [&o](GroundLink& l) { return get_parameters(l, o.names, o.json, std::cout); };
  }
  if (chosen("set")) {
    return [&o, set = parse_assignments(o.assignments)](GroundLink& l) {
      return set_parameters(l, set, o.write, std::cout);
    };
  }
  if (chosen("save")) {
    if (!o.force && std::filesystem::exists(o.file)) {
      throw config::Error(o.file + ": found a file, allowed a new one, or --force");
    }
    return [&o](GroundLink& l) { return save_parameters(l, o.file, o.changed, std::cout); };
  }
  auto set = read_checked_file(o.file);
  if (chosen("load")) {
    return [&o, set](GroundLink& l) { return load_parameters(l, set, o.write, std::cout); };
  }
  return [&o, set](GroundLink& l) { return diff_parameters(l, set, o.all, o.json, std::cout); };
}

CLI::App* add_monitor(CLI::App& app, LinkChoice& choice, MonitorOptions& o) {
  CLI::App* command = app.add_subcommand("monitor", "Shows what a vehicle sends until Ctrl-C");
  add_link(*command, choice);
  command->add_option("--period", o.period_s, "Time between two outputs [s]")
      ->check(CLI::Range(0.02, 3600.0))
      ->capture_default_str();
  command->add_flag("--once", o.once, "Show it once and end");
  command->add_flag("--json", o.json, "A JSON object a line");
  return command;
}

CLI::App* add_preflight(CLI::App& app, LinkChoice& choice, bool& json) {
  CLI::App* command = app.add_subcommand(
      "preflight",
      "Checks before arming as a table; exit code 1 if one fails (docs/ground-tools.md)");
  add_link(*command, choice);
  command->add_flag("--json", json, "Print JSON");
  return command;
}

CLI::App* add_blackbox(CLI::App& app, LinkChoice& choice, std::string& folder) {
  CLI::App* command = app.add_subcommand(
      "blackbox",
      "Reads the flight record of a board into a flight folder; exit code 1 if there is none");
  add_link(*command, choice);
  command->add_option("--out", folder, "Folder, new or empty")->capture_default_str();
  return command;
}

void check_new_folder(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  if (fs::exists(folder) && (!fs::is_directory(folder) || !fs::is_empty(folder))) {
    throw config::Error("--out: found " + folder.string() +
                        " with something in it, allowed a new or empty folder");
  }
}

struct CalibrateOptions {
  std::string what;
  double wait_s{60.0};
  CalibrationOptions calibration;
};

constexpr auto seconds(double s) {
  return std::chrono::duration_cast<Time>(std::chrono::duration<double>(s));
}

using Calibration = int (*)(GroundLink&, const CalibrationOptions&, std::ostream&);
const std::map<std::string, Calibration> kCalibrations{
    {"gyro", calibrate_gyro}, {"accel", calibrate_accel},       {"mag", calibrate_mag},
    {"baro", calibrate_baro}, {"airspeed", calibrate_airspeed}, {"rc", calibrate_rc},
    {"esc", calibrate_esc}};

CLI::App* add_calibrate(CLI::App& app, LinkChoice& choice, CalibrateOptions& o) {
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "Calibrates a sensor, the receiver or the speed controllers; exit code 1 if not good enough");
  add_link(*command, choice);
  std::vector<std::string> kinds;
  for (const auto& [name, calibration] : kCalibrations) kinds.push_back(name);
  command->add_option("WHAT", o.what, "gyro, accel, mag, baro, airspeed, rc or esc")
      ->required()
      ->check(one_of(kinds));
  command->add_option("--wait", o.wait_s, "Wait so long for each step that a person does [s]")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->add_flag("--write", o.calibration.write,
                    "Store all parameters in the vehicle's memory if it was good");
  command->add_flag("--props-off", o.calibration.props_off,
                    "No propeller is mounted; esc needs this");
  return command;
}

int run_connected(const LinkChoice& choice, const Action& action) {
  const base::SignalWatch watch;
  try {
    GroundLink link({choice.link, seconds(choice.timeout_s),
                     static_cast<std::uint8_t>(choice.system),
                     [] { return base::stop_signal() != 0; }});
    link.connect();
    return action(link);
  } catch (const Stopped&) {
    std::cout << std::flush;
    return 128 + base::stop_signal();
  }
}

}  // namespace

int ground_command_line(int argc, char** argv) {
  CLI::App app{
      "rosflight: params, calibrate, monitor, preflight and blackbox. ./rosflight --help lists "
      "all commands."};
  LinkChoice choice;
  ParamsOptions params_options;
  MonitorOptions monitor_options;
  bool json = false;
  const CLI::App* params = add_params(app, choice, params_options);
  const CLI::App* monitor_app = add_monitor(app, choice, monitor_options);
  CalibrateOptions calibrate_options;
  const CLI::App* calibrate = add_calibrate(app, choice, calibrate_options);
  add_preflight(app, choice, json);
  std::string folder = "blackbox";
  const CLI::App* blackbox = add_blackbox(app, choice, folder);
  return parse_and_run(app, argc, argv, [&] {
    if (*monitor_app) {
      monitor_options.in_place = ::isatty(STDOUT_FILENO) != 0;
      return run_connected(choice,
                           [&](GroundLink& l) { return monitor(l, monitor_options, std::cout); });
    }
    if (*calibrate) {
      calibrate_options.calibration.wait = seconds(calibrate_options.wait_s);
      return run_connected(choice, [&](GroundLink& l) {
        return kCalibrations.at(calibrate_options.what)(l, calibrate_options.calibration,
                                                        std::cout);
      });
    }
    if (*blackbox) {
      check_new_folder(folder);
      return run_connected(choice,
                           [&](GroundLink& l) { return read_blackbox(l, folder, std::cout); });
    }
    if (!*params) {
      return run_connected(choice, [&](GroundLink& l) {
        return print_preflight(judge_preflight(observe_preflight(l)), json, std::cout);
      });
    }
    return run_connected(choice, params_action(*params, params_options));
  });
}

}  // namespace rosflight::apps
