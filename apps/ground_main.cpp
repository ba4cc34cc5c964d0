// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight params, calibrate, monitor, preflight and blackbox.
#include "apps/ground_command_line.hpp"

int main(int argc, char** argv) {
  return rosflight::apps::ground_command_line(argc, argv);
}
