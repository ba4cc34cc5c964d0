// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <optional>
#include <ostream>
#include <string>
#include <utility>

#include "apps/flight_commander.hpp"
#include "apps/fly_command.hpp"
#include "apps/page_server.hpp"
#include "apps/stop_signal.hpp"
#include "apps/view_command.hpp"
#include "log/topic_kinds.hpp"

namespace rosflight::apps {
namespace {

using log::Topic;
using web::server::Contents;
using web::server::LiveData;
using web::server::Right;

class LiveFlight final : public FlightWatch, public log::LogObserver {
 public:
  LiveFlight(const web::server::Access& access, bool hold, std::ostream& err)
      : err_{err}, commands_{desk_, hold, [] { return stop_signal() != 0; }} {
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

  log::LogObserver& observer() override { return *this; }
  flight::Commander& commander() override { return commands_; }

  void on_logged(Topic topic, std::uint64_t time_ns, log::Bytes cdr) override {
    const log::TopicKind topic_kind = log::kind_of(topic);
    if (topic_kind == log::TopicKind::kBulk) return;
    auto& channel = channels_.at(static_cast<std::size_t>(topic));
    if (!channel) {
      const log::TopicType& type = log::kTopics.at(static_cast<std::size_t>(topic));
      const auto kind =
          topic_kind == log::TopicKind::kEvent ? LiveData::Kind::kEvent : LiveData::Kind::kState;
      channel = data_.add_channel(
          {std::string(type.name), std::string(type.type), std::string(type.schema()), kind});
    }
    data_.put(*channel, time_ns, cdr);
  }

  std::optional<std::string> stay(const flight::FlightSummary& /*summary*/) override {
    err_ << "rosflight: the flight has ended; its page stays until Ctrl-C" << std::endl;
    auto mission = commands_.next_mission();
    if (mission) {
      data_.restart();
      channels_.fill(std::nullopt);
    }
    return mission;
  }

 private:
  std::ostream& err_;
  LiveData data_;
  web::server::CommandDesk desk_;
  FlightCommander commands_;
  std::array<std::optional<std::size_t>, log::kTopics.size()> channels_;
  std::unique_ptr<web::server::WebServer> server_;  ///< Ends first: it uses the others.
};

}  // namespace

std::unique_ptr<FlightWatch> watch_flight(const web::server::Access& access, bool hold,
                                          std::ostream& err) {
  return std::make_unique<LiveFlight>(access, hold, err);
}

}  // namespace rosflight::apps
