// SPDX-License-Identifier: BSD-3-Clause
#include "apps/sil/sil_cli.hpp"

#include "apps/link_protocol.hpp"
#include "apps/options.hpp"
#include "sim/faults.hpp"

namespace rosflight::apps {

CLI::App* add_sil(CLI::App& app, SilOptions& options) {
  CLI::App* sil = app.add_subcommand(
      "sil", "run the firmware as a process in real time, its serial port on a pty, UDP or TCP");
  sil->add_option("--vehicle", options.vehicle, "name of a vehicle or a vehicle file")
      ->capture_default_str();
  sil->add_option("--set", options.overrides, "vehicle.section.key=value, may be repeated")
      ->type_name("ASSIGNMENT")
      ->allow_extra_args(false);
  sil->add_option("--plugin", options.plugins, "shared library with modules of your own")
      ->type_name("FILE")
      ->allow_extra_args(false);
  sil->add_option("--link", options.link,
                  "serial port: pty[:PATH], udp:HOST:PORT, tcp:PORT or tcp:HOST:PORT; tcp:PORT "
                  "listens on 127.0.0.1 only")
      ->type_name("ADDRESS")
      ->capture_default_str();
  sil->add_option("--listen", options.listen,
                  "own port of a UDP link [14525 if the far end is 14520, otherwise any free one]")
      ->type_name("PORT");
  sil->add_option("--link-protocol", options.link_protocol,
                  "what the board speaks: mavlink or lean; ground tools of ROSflight want mavlink")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(CLI::IsMember(link_protocols()));
  sil->add_option("--nvm", options.storage, "file that keeps the parameters; created if missing")
      ->type_name("FILE")
      ->capture_default_str();
  sil->add_option("--rate", options.rate_Hz, "IMU samples and simulation steps a second")
      ->check(CLI::Range(SilOptions::kLowestRate_Hz, SilOptions::kHighestRate_Hz))
      ->capture_default_str();
  sil->add_option("--rc", options.rc, "script of the pilot (YAML); without one the sticks rest")
      ->type_name("FILE");
  sil->add_option("--duration", options.duration_s, "end after so many seconds")
      ->type_name("S")
      ->check(CLI::PositiveNumber);
  sil->add_option("--fault", options.faults, "something breaks, may be repeated; see below")
      ->type_name("WHAT@TIME[:DURATION]")
      ->allow_extra_args(false);
  sil->add_option("--seed", options.seed, "of everything random")
      ->check(whole_number)
      ->capture_default_str();
  sil->footer("Faults, times in seconds:\n" + sim::fault_help());
  return sil;
}

}  // namespace rosflight::apps
