// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/host/chip_process.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <utility>

namespace rosflight::boards::stm32h7 {

ChipProcess::ChipProcess(const Options& options) : options_{options} {
  if (!std::filesystem::exists(options_.program)) {
    throw EmulatorError(
        options_.program.string() +
        " is not built: tools/ready.sh venv, then tools/ready.sh build release h7_emulator");
  }
  if (!std::filesystem::exists(options_.image)) {
    throw EmulatorError(options_.image.string() + " is not built: ./rosflight firmware build " +
                        options_.board +
                        " makes it, with the compiler of the package gcc-arm-none-eabi");
  }
  memory_ = base::FileDescriptor{::memfd_create("rosflight_h7", MFD_CLOEXEC)};
  if (!memory_.valid() || ::ftruncate(memory_.get(), sizeof(Exchange)) != 0) {
    throw EmulatorError("cannot get memory for the emulated chip");
  }
  void* const mapped =
      ::mmap(nullptr, sizeof(Exchange), PROT_READ | PROT_WRITE, MAP_SHARED, memory_.get(), 0);
  if (mapped == MAP_FAILED) throw EmulatorError("cannot map memory for the emulated chip");
  block_ = static_cast<Exchange*>(mapped);
}

ChipProcess::~ChipProcess() {
  child_.stop();
  ::munmap(block_, sizeof(Exchange));
}

void ChipProcess::start() {
  *block_ = Exchange{};
  Pipe to_chip;
  Pipe from_chip;
  child_.start({options_.program.string(), options_.board, options_.image.string()},
               {{to_chip.read.get(), kToChipFd},
                {from_chip.write.get(), kFromChipFd},
                {memory_.get(), kBlockFd}});
  to_chip_ = std::move(to_chip.write);
  from_chip_ = std::move(from_chip.read);
}

void ChipProcess::exchange() {
  constexpr char kReady = 'r';
  one_processor_.next_turn(child_.process());
  child_.send(to_chip_.get(), kReady);
  child_.receive(from_chip_.get(), options_.timeout);
  const FromChip& answer = block_->from_chip;
  if (answer.complaints == 0) return;
  child_.give_up(std::to_string(answer.complaints) +
                 " complaint(s) of the models, the first: " + answer.text.data());
}

}  // namespace rosflight::boards::stm32h7
