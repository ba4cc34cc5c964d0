// SPDX-License-Identifier: BSD-3-Clause
#include "apps/vehicle_view.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <utility>

#include "apps/live_log.hpp"
#include "apps/page_server.hpp"
#include "apps/stop_signal.hpp"
#include "apps/viewer_commands.hpp"
#include "flight/fly.hpp"
#include "ground/ground_link.hpp"
#include "log/flight_log.hpp"

namespace rosflight::apps {
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

/// Writes what crosses the link into a log.
class LinkRecorder final : private companion::Listener {
 public:
  LinkRecorder(ground::GroundLink& link, log::FlightLog& log)
      : link_{link}, log_{log}, start_{link.now()} {
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
    const auto* change = std::get_if<companion::ConnectionEvent>(&event);
    if (change == nullptr) return;
    const bool lost = change->change == companion::ConnectionChange::kLost;
    connected_ = connected_ || !lost;
    log_.write_event(now(), lost ? link::Severity::kWarning : link::Severity::kInfo, "companion",
                     lost ? "link lost" : "link up");
  }

  ground::GroundLink& link_;
  log::FlightLog& log_;
  companion::Time start_;
  bool connected_{false};
};

web::server::Contents vehicle_contents(const std::string& link) {
  web::server::Contents contents = page_contents();
  const nlohmann::json offer{{"live", true}, {"name", link}};
  contents.texts["offer.json"] =
      offer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return contents;
}

}  // namespace

bool is_link(std::string_view text) {
  constexpr std::array<std::string_view, 5> kStarts{"serial:", "pty:", "udp:", "tcp:", "/dev/"};
  for (const std::string_view start : kStarts)
    if (text.starts_with(start)) return true;
  return false;
}

int view_vehicle(const ViewOptions& options, std::ostream& out) {
  const std::string name = options.input.string();
  const SignalWatch watch;
  ground::GroundLink link({name, std::chrono::seconds{5}, 1, [] { return stop_signal() != 0; }});
  web::server::LiveData data;
  web::server::CommandDesk desk;
  web::server::Contents contents = vehicle_contents(name);
  contents.live = &data;
  contents.desk = &desk;
  const std::filesystem::path folder = flight::make_flight_folder(options.folder);
  LiveLog live(data);
  log::FlightLog log(folder / "flight.mcap", log_options(live), {{"link", name}});
  log.attach("link.txt", "text/plain", name);
  LinkRecorder recorder(link, log);
  ViewerCommands commands(desk);
  const ViewerCommands::Log note = [&recorder](std::uint64_t viewer, const std::string& text) {
    recorder.note("viewer", fmt::format("viewer {} {}", viewer, text));
  };
  const auto server = serve(std::move(contents), options.access);
  out << server->address(web::server::Right::kCommand) << "  (Ctrl-C ends it)" << std::endl;
  if (!options.access.listen.empty())
    out << server->address() << "  (without the right to command)" << std::endl;
  companion::Job<companion::ParameterClient::ListResult> list;
  try {
    for (;;) {
      link.run_for(kTurn);
      if (recorder.take_connected()) list = link.session().parameters().refresh();
      commands.step(link.session(), note);
      desk.set_control({commands.in_control(), false, false, 1.0});
    }
  } catch (const ground::Stopped&) {
    out << folder.string() << "  (the log)" << std::endl;
  }
  log.close();
  return 0;
}

}  // namespace rosflight::apps
