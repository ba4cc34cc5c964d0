// SPDX-License-Identifier: BSD-3-Clause
// Gazebo's server without a window, for machines with its libraries but without its program, and for tests: runs a world
// file until it is stopped.
//
// usage: gazebo_server FILE
#include <iostream>
#ifdef ROSFLIGHT_GZ_SIM
#include <gz/sim/Server.hh>
#include <gz/sim/ServerConfig.hh>
namespace gazebo_sim = gz::sim;
#else
#include <ignition/gazebo/Server.hh>
#include <ignition/gazebo/ServerConfig.hh>
namespace gazebo_sim = ignition::gazebo;
#endif

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: gazebo_server FILE\n";
    return 2;
  }
  gazebo_sim::ServerConfig config;
  if (!config.SetSdfFile(argv[1])) {
    std::cerr << "gazebo_server: found no world file " << argv[1] << "\n";
    return 2;
  }
  gazebo_sim::Server server(config);
  constexpr bool kBlocking = true;
  constexpr bool kPaused = false;
  return server.Run(kBlocking, 0, kPaused) ? 0 : 1;
}
