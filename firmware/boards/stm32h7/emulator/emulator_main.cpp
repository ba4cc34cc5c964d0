// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/emulate.hpp"

int main(int argc, char** argv) {
  return rosflight::boards::stm32h7::emulator::emulate(argc, argv);
}
