// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight.
#include "apps/command_line.hpp"

int main(int argc, char** argv) {
  return rosflight::apps::command_line(argc, argv);
}
