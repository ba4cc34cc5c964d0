// SPDX-License-Identifier: BSD-3-Clause
#include "flight/repeat.hpp"

#include <cstdint>
#include <sstream>

#include "config/strict_yaml.hpp"
#include "log/mcap_reader.hpp"
#include "messages/cdr_reader.hpp"

namespace rosflight::flight {
namespace {

std::vector<std::string> pieces(const std::string& text, char mark) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string piece; std::getline(stream, piece, mark);) out.push_back(piece);
  return out;
}

/// A text of the log that says what people did.
void take_text(messages::CdrReader from, sim::Time at, RecordedFlight& flight) {
  std::int32_t sec{};
  std::uint32_t nanosec{};
  std::uint8_t level{};
  std::string source;
  std::string text;
  from.take(sec);
  from.take(nanosec);
  from.take(level);
  from.take(source);
  from.take(text);
  if (source == kViewer) flight.commands.push_back({at, text});
  if (source == kOperator) flight.ended = at;
}

FlightChoice choice_of(const log::TextMap& facts) {
  FlightChoice choice;
  choice.vehicle = facts.at("vehicle_argument");
  choice.mission = facts.at("mission_argument");
  choice.seed = std::stoull(facts.at("seed"));
  choice.link_protocol = facts.at("link_protocol");
  choice.state = facts.at("state");
  choice.pilot = facts.at("pilot");
  if (const auto physics = facts.find("physics"); physics != facts.end())
    choice.physics = physics->second;
  if (const auto world = facts.find("world"); world != facts.end()) choice.world = world->second;
  if (const auto sum = facts.find("world_sha256"); sum != facts.end())
    choice.world_sha256 = sum->second;
  choice.faults = pieces(facts.at("faults"), ' ');
  choice.overrides = pieces(facts.at("overrides"), '\n');
  choice.plugins = pieces(facts.at("plugins"), '\n');
  if (const std::string& wind = facts.at("wind"); !wind.empty()) choice.wind = wind;
  return choice;
}

}  // namespace

RecordedFlight read_recorded_flight(const std::filesystem::path& log) {
  const std::filesystem::path file = std::filesystem::is_directory(log) ? log / "flight.mcap" : log;
  RecordedFlight flight;
  try {
    log::McapReader reader(file);
    reader.read([&](const log::McapReader::Message& message) {
      if (message.topic != "/rosout") return;
      constexpr std::uint64_t kPerMicrosecond_ns = 1000;
      const auto since_ns = message.log_time_ns - reader.start_ns();
      take_text(messages::CdrReader(message.data),
                sim::Time{static_cast<sim::Time::rep>(since_ns / kPerMicrosecond_ns)}, flight);
    });
    flight.choice = choice_of(reader.flight());
    flight.log = reader.flight().at("log");
    flight.sha256 = reader.sha256();
  } catch (const std::logic_error&) {
    throw config::Error("--repeat: found " + file.string() +
                        " without the options of its flight, allowed a log of ./rosflight fly of "
                        "this version");
  } catch (const std::runtime_error& error) {
    throw config::Error(std::string("--repeat: ") + error.what());
  }
  return flight;
}

}  // namespace rosflight::flight
