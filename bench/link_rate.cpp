// SPDX-License-Identifier: BSD-3-Clause
// What telemetry takes of the cable: bytes a second from the board to the companion during the
// mission of the default flight, all stream rates as they are by default. Texts and what the
// companion asks for (TIMESYNC) are in it, the listing of parameters before the flight is not.
//
// usage: link_rate (mavlink | lean)
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "flight/flight.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file

class Meter final : public flight::LinkTap {
 public:
  void on_frame(flight::Direction direction, hal::Time /*t*/, const std::uint8_t* /*data*/,
                std::size_t size, bool /*taken*/) override {
    if (direction != flight::Direction::kToCompanion) return;
    bytes_ += size;
    ++frames_;
  }
  std::size_t bytes() const { return bytes_; }
  std::size_t frames() const { return frames_; }

 private:
  std::size_t bytes_{0};
  std::size_t frames_{0};
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: link_rate (mavlink | lean)\n");
    return 2;
  }
  try {
    flight::FlightChoice choice;
    choice.link_protocol = argv[1];
    const auto setup = std::make_unique<flight::FlightSetup>(choice);
    const auto flight = std::make_unique<flight::Flight>(*setup);
    const auto in_stage = [&flight](flight::Stage stage) {
      return flight->runner().stage() == stage;
    };
    while (!flight->runner().finished() && !in_stage(flight::Stage::kFly)) flight->step();
    Meter meter;
    const sim::Time begin = flight->now();
    flight->set_tap(&meter);
    while (in_stage(flight::Stage::kFly)) flight->step();
    const double took_s = sim::to_seconds(flight->now() - begin);
    flight->run();
    if (!in_stage(flight::Stage::kDone)) {
      std::fprintf(stderr, "link_rate: the flight failed: %s\n",
                   flight->runner().failure().c_str());
      return 1;
    }
    std::cout
        << nlohmann::ordered_json{{"bytes_per_s", static_cast<double>(meter.bytes()) / took_s},
                                  {"frames_per_s", static_cast<double>(meter.frames()) / took_s}}
        << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "link_rate: %s\n", e.what());
    return 1;
  }
}
