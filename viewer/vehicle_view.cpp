// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/vehicle_view.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>

#include "base/atomic_file.hpp"
#include "base/stop_signal.hpp"
#include "companion/check_list.hpp"
#include "config/strict_yaml.hpp"
#include "flight/fly.hpp"
#include "flight/preflight_json.hpp"
#include "ground/calibration.hpp"
#include "ground/ground_link.hpp"
#include "log/flight_log.hpp"
#include "viewer/live_log.hpp"
#include "viewer/other_vehicle.hpp"
#include "viewer/page_server.hpp"
#include "viewer/viewer_commands.hpp"

namespace rosflight::viewer {
namespace {

using namespace std::chrono_literals;

constexpr auto kTurn = 5ms;  // a command waits no longer

log::FlightLog::Options log_options(LiveLog& live) {
  log::FlightLog::Options options;
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  options.epoch_ns = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count());
  options.mcap.compression = log::Compression::kZstdFast;
  options.observers = {&live};
  return options;
}

/// Writes what crosses the link into a log, and the firmware's checks before arming into a file.
class LinkRecorder final : private companion::Listener {
 public:
  LinkRecorder(ground::GroundLink& link, log::FlightLog& log, std::filesystem::path checks)
      : link_{link}, log_{log}, checks_file_{std::move(checks)}, start_{link.now()} {
    link_.session().add(*this);
  }
  ~LinkRecorder() override { link_.session().remove(*this); }
  LinkRecorder(const LinkRecorder&) = delete;
  LinkRecorder& operator=(const LinkRecorder&) = delete;

  void note(const std::string& source, const std::string& text) {
    log_.write_event(now(), link::Severity::kInfo, source, text);
  }
  /// The link is up since the last call: its parameters are not known yet.
  bool take_connected() { return std::exchange(connected_, false); }

 private:
  /// In the time of the log.
  hal::Time since_start(companion::Time at) const {
    return std::chrono::duration_cast<hal::Time>(at - start_);
  }
  hal::Time now() const { return since_start(link_.now()); }
  void on_received(const link::Message& message, const companion::Stamp&) override {
    const companion::TimeSync& sync = link_.session().time_sync();
    if (sync.synchronised()) log_.set_fcu_boot(since_start(sync.to_companion({})));
    log_.write_link(log::Direction::kFcuToCompanion, now(), message, {});
  }
  void on_sent(const link::Message& message, companion::Time) override {
    log_.write_link(log::Direction::kCompanionToFcu, now(), message, {});
  }
  void on_event(const companion::Event& event) override {
    const bool armed = link_.streams().status.value.armed;
    if (!armed && checks_.add(link_.now(), event))
      base::write_file(checks_file_, flight::preflight_json(checks_, start_));
    const auto* change = std::get_if<companion::ConnectionEvent>(&event);
    if (change == nullptr) return;
    const bool lost = change->change == companion::ConnectionChange::kLost;
    connected_ = connected_ || !lost;
    log_.write_event(now(), lost ? link::Severity::kWarning : link::Severity::kInfo, "companion",
                     lost ? "link lost" : "link up");
  }

  ground::GroundLink& link_;
  log::FlightLog& log_;
  std::filesystem::path checks_file_;
  companion::CheckList checks_;
  companion::Time start_;
  bool connected_{false};
};

using Procedure = int (*)(ground::GroundLink&, const ground::CalibrationOptions&, std::ostream&);

Procedure procedure_named(const std::string& name) {
  return name == "mag"  ? ground::calibrate_mag
         : name == "rc" ? ground::calibrate_rc
                        : ground::calibrate_esc;
}

/// Passes each line on.
class LineBuffer final : public std::stringbuf {
 public:
  explicit LineBuffer(std::function<void(const std::string&)> take) : take_{std::move(take)} {}

 private:
  int sync() override {
    std::istringstream lines(str());
    str("");
    for (std::string line; std::getline(lines, line);) take_(line);
    return 0;
  }
  std::function<void(const std::string&)> take_;
};

/// Runs a calibration as ./rosflight calibrate does; its lines go to the log, and so to the viewers.
/// @throws Stopped  the program is to end.
void run_procedure(ground::GroundLink& link, const std::string& name, ViewerCommands& commands,
                   const ViewerCommands::Log& note) {
  std::string last;
  std::string stopped{"stopped"};
  LineBuffer buffer([&](const std::string& line) {
    if (line.starts_with("not stored")) return;  // the page has a button for it
    last = line;
    if (commands.procedure_stopped()) stopped = "stopped; " + line;
    commands.log_line(line, note);
  });
  std::ostream out(&buffer);
  ground::CalibrationOptions options;
  options.props_off = true;  // the name says so
  try {
    const int code = procedure_named(name)(link, options, out);
    commands.end_procedure(code == 0, last);
  } catch (const ground::NoAnswer& error) {
    commands.end_procedure(false, error.what());
  } catch (const ground::Stopped&) {
    commands.end_procedure(false, stopped);
    if (base::stop_signal() != 0) throw;
  }
}

void check_compared(const VehicleViewOptions& options) {
  if (options.compare.empty()) return;
  if (!is_link(options.compare) || options.compare == options.link) {
    throw config::Error("--compare: found " + options.compare +
                        ", allowed a link to another vehicle, as INPUT");
  }
}

void add_vehicle(const VehicleViewOptions& options, const std::filesystem::path& other,
                 web::server::Contents& contents) {
  nlohmann::json offer{{"live", true}, {"name", options.link}};
  if (!options.compare.empty()) {
    contents.files["flight/other_parameters.yaml"] = other;
    offer["other"] = {{"name", options.compare}, {"parameters", "flight/other_parameters.yaml"}};
  }
  contents.texts["offer.json"] =
      offer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

bool is_link(std::string_view text) {
  constexpr std::array<std::string_view, 5> kStarts{"serial:", "pty:", "udp:", "tcp:", "/dev/"};
  for (const std::string_view start : kStarts)
    if (text.starts_with(start)) return true;
  return false;
}

int view_vehicle(const VehicleViewOptions& options, std::ostream& out) {
  check_compared(options);
  web::server::Contents contents = page_contents();  // an error must leave no folder
  const std::string name = options.link;
  const base::SignalWatch watch;
  web::server::LiveData data;
  web::server::CommandDesk desk;
  ViewerCommands commands(desk);
  commands.set_procedures({"mag", "rc", "esc_props_off"});
  std::function<void()> serve_viewers;
  ground::GroundLink link(
      {name, std::chrono::seconds{5}, 1,
       [&commands] { return base::stop_signal() != 0 || commands.procedure_stopped(); },
       [&serve_viewers] { serve_viewers(); }});
  std::optional<OtherVehicle> other;
  if (!options.compare.empty()) other.emplace(options.compare);
  const std::filesystem::path folder = flight::make_flight_folder(options.folder);
  const std::filesystem::path other_file = folder / "other_parameters.yaml";
  if (other) other->set_file(other_file);
  add_vehicle(options, other_file, contents);
  contents.live = &data;
  contents.desk = &desk;
  LiveLog live(data);
  log::FlightLog log(folder / "flight.mcap", log_options(live), {{"link", name}});
  log.attach("link.txt", "text/plain", name);
  LinkRecorder recorder(link, log, folder / "preflight.json");
  const ViewerCommands::Log note = [&recorder](std::uint64_t viewer, const std::string& text) {
    recorder.note("viewer", fmt::format("viewer {} {}", viewer, text));
  };
  const auto server = serve(std::move(contents), options.access);
  out << server->address(web::server::Right::kCommand) << "  (Ctrl-C ends it)" << std::endl;
  if (!options.access.listen.empty())
    out << server->address() << "  (without the right to command)" << std::endl;
  companion::Job<companion::ParameterClient::ListResult> list;
  serve_viewers = [&] {
    if (other) other->step();
    if (recorder.take_connected()) {
      list = link.session().parameters().refresh();
      static_cast<void>(link.session().request_report(link::ReportKind::kChecks));
    }
    commands.step(link.session(), note);
    desk.set_control({commands.in_control(), false, false, 1.0});
  };
  try {
    for (;;) {
      link.run_for(kTurn);
      if (const auto procedure = commands.begin_procedure())
        run_procedure(link, *procedure, commands, note);
    }
  } catch (const ground::Stopped&) {
    out << folder.string() << "  (the log)" << std::endl;
  }
  log.close();
  return 0;
}

}  // namespace rosflight::viewer
