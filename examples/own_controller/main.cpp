// SPDX-License-Identifier: BSD-3-Clause
// Flies a mission with the controller of this folder and leaves a flight folder, as
// `./rosflight fly` does.
#include <iostream>
#include <memory>

#include "apps/fly/fly_command.hpp"
#include "examples/own_controller/own_guide.hpp"

int main(int argc, char** argv) {
  using namespace rosflight;
  if (argc < 2 || argc > 3) {
    std::cerr << "usage: own_controller FOLDER [MISSION]\n";
    return 2;
  }
  try {
    apps::FlyOptions options;
    options.out = argv[1];
    if (argc > 2) options.choice.mission = argv[2];
    options.guide = own_controller::own_guide;
    return apps::fly_command(options, std::cout, std::cerr);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
