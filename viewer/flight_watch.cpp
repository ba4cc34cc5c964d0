// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/flight_watch.hpp"

#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include "base/stop_signal.hpp"
#include "viewer/flight_commander.hpp"
#include "viewer/live_log.hpp"
#include "viewer/page_server.hpp"

namespace rosflight::viewer {
namespace {

using web::server::Contents;
using web::server::LiveData;
using web::server::Right;

class LiveFlight final : public FlightWatch {
 public:
  LiveFlight(const web::server::Access& access, bool hold, std::ostream& err)
      : err_{err}, commands_{desk_, hold, [] { return base::stop_signal() != 0; }} {
    Contents contents = page_contents();
    contents.texts["offer.json"] = R"({"live":true,"name":"flight"})";
    contents.live = &data_;
    contents.desk = &desk_;
    server_ = serve(std::move(contents), access);
    err_ << server_->address(Right::kCommand) << std::endl;
    if (!access.listen.empty()) {
      err_ << server_->address(Right::kLook) << "  (without the right to command)" << std::endl;
    }
  }

  log::LogObserver& observer() override { return live_; }
  flight::Commander& commander() override { return commands_; }

  std::optional<std::string> stay(const flight::FlightSummary& /*summary*/) override {
    err_ << "rosflight: the flight has ended; its page stays until Ctrl-C" << std::endl;
    auto mission = commands_.next_mission();
    if (mission) live_.restart();
    return mission;
  }

 private:
  std::ostream& err_;
  LiveData data_;
  web::server::CommandDesk desk_;
  FlightCommander commands_;
  LiveLog live_{data_};
  std::unique_ptr<web::server::WebServer> server_;  ///< Ends first: it uses the others.
};

}  // namespace

std::unique_ptr<FlightWatch> watch_flight(const web::server::Access& access, bool hold,
                                          std::ostream& err) {
  return std::make_unique<LiveFlight>(access, hold, err);
}

}  // namespace rosflight::viewer
