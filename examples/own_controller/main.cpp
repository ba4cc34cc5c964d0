// SPDX-License-Identifier: BSD-3-Clause
// Flies a mission with the controller of this folder and leaves a flight folder, as
// `./rosflight fly` does.
#include <iostream>
#include <memory>

#include "flight/fly.hpp"
#include "own_guidance.hpp"

int main(int argc, char** argv) {
  using namespace rosflight;
  if (argc < 2 || argc > 3) {
    std::cerr << "usage: own_controller FOLDER [MISSION]\n";
    return 2;
  }
  try {
    flight::FlyOptions options;
    options.folder = argv[1];
    if (argc > 2) options.choice.mission = argv[2];
    options.parts = [](const flight::FlightSetup& setup) {
      flight::FlightParts parts;
      parts.guidance = own_controller::own_guidance(setup);
      return parts;
    };
    const flight::FlightSummary summary = flight::fly(options);
    std::cout << summary.score.verdict << " Tracking error " << summary.tracking.rms()
              << " m rms, flight folder " << summary.folder.string() << '\n';
    return summary.score.success() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
