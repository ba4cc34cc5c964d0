// SPDX-License-Identifier: BSD-3-Clause
// The program behind ./rosflight replay, sil, mixer, trim and sdf.
#include "apps/tools_command_line.hpp"

int main(int argc, char** argv) {
  return rosflight::apps::tools_command_line(argc, argv);
}
