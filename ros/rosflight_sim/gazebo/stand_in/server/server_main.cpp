// SPDX-License-Identifier: BSD-3-Clause
// Runs a world file until it is stopped, as `ign gazebo -s -r FILE` does. SIGUSR1 pauses, or resumes.
//
// usage: gazebo_stand_in FILE
#include <atomic>
#include <csignal>
#include <exception>
#include <iostream>
#include <thread>

#include "stand_in_world.hpp"

namespace {

std::atomic_bool end_asked{false};
std::atomic_bool pause_asked{false};

void on_signal(int signal) {
  (signal == SIGUSR1 ? pause_asked : end_asked) = true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: gazebo_stand_in FILE\n";
    return 2;
  }
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, on_signal);
  try {
    rosflight_sim::StandInWorld world(argv[1]);
    std::cout << "ready" << std::endl;
    auto next = std::chrono::steady_clock::now();
    while (!end_asked && !world.stopped()) {
      if (pause_asked.exchange(false)) world.set_paused(!world.paused());
      world.iterate();
      next = std::max(next + world.period(), std::chrono::steady_clock::now() - world.period());
      std::this_thread::sleep_until(next);
    }
  } catch (const std::exception& error) {
    std::cerr << "gazebo_stand_in: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
