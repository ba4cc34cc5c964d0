// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight::boards::stm32h7::emulator {

/// The program of the emulated chip: EMULATOR BOARD IMAGE.elf, started by stm32h7::ChipProcess.
/// @returns its exit code.
int emulate(int argc, char** argv);

}  // namespace rosflight::boards::stm32h7::emulator
