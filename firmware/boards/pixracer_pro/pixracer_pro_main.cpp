// SPDX-License-Identifier: BSD-3-Clause
// The image: board, link and firmware put together, and the interrupts of the board.
#include "firmware/boards/common/glance_main.hpp"
#include "firmware/boards/common/mavlink_main.hpp"
#include "firmware/boards/common/place.hpp"
#include "firmware/boards/pixracer_pro/pixracer_pro_board.hpp"
#include "firmware/boards/stm32h7/startup.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): this is their main
using namespace rosflight::boards::stm32h7;  // NOLINT(google-build-using-namespace)
using boards::pixracer_pro::DmaMemory;
using boards::pixracer_pro::PixracerPro;

struct Autopilot {
  explicit Autopilot(const hal::Board& board) : firmware{board, link.codec} {}
  boards::BoardLink link;
  core::Firmware firmware;
};

// One of each in an image; the interrupt handlers must find them. All zero at start.
boards::Place<PixracerPro> board_place;
boards::Place<Autopilot> autopilot_place;
__attribute__((section(".dma"))) DmaMemory dma_memory;

PixracerPro& board() {
  return *board_place.get();
}

constexpr std::uint32_t kSram3Size = 0x8000u;

constexpr Interrupt kInterrupts[] = {
    {irq::EXTI3, [] { board().on_gyro_ready(); }},
    {irq::SPI5, [] { board().on_gyro_sample(); }},
    {irq::DMA1_STREAM5, [] { board().on_imu_bus(); }},
    {irq::DMA1_STREAM3, [] { board().on_baro_bus(); }},
    {irq::I2C1_EV, [] { board().on_external_bus(); }},
    {irq::I2C1_ER, [] { board().on_external_bus(); }},
    {irq::UART4, [] { board().on_gnss(); }},
    {irq::DMA1_STREAM0, [] { board().on_gnss_sent(); }},
    {irq::EXTI15_10, [] { board().on_pulse_per_second(); }},
    {irq::USART2, [] { board().on_link(); }},
    {irq::DMA2_STREAM0, [] { board().on_link_sent(); }},
    {irq::USART6, [] { board().on_receiver(); }},
    {irq::TIM7, [] { board().on_tick(); }},
    {irq::TIM6_DAC, board_take_fault},  // the watchdog's warning
};

}  // namespace

extern "C" {

/// For debuggers and for the emulated board, which finds it by its name.
boards::FirmwareGlance board_glance;

extern const VectorTable board_vectors;
__attribute__((section(".vectors"), used)) const VectorTable board_vectors =
    make_vectors(kInterrupts);

void board_fault(const FaultRegisters& registers) {
  if (Autopilot* const autopilot = autopilot_place.get())
    autopilot->firmware.record_fault(registers);
}

[[noreturn]] void board_main() {
  start_clocks(boards::pixracer_pro::kOscillator);
  open_gate(kSram3);
  open_backup_memory();
  make_uncached(0, kSram3.base, kSram3Size);
  make_uncached(1, kBackupMemory, kBackupMemorySize);
  start_memory_system();
  start_microseconds();
  open_ports();
  const bool cold = take_reset_cause() == ResetCause::kPowerOn;
  PixracerPro& here = board_place.make(
      dma_memory, cold ? boards::parts::Start::kCold : boards::parts::Start::kWarm);
  here.open();
  core::Firmware& firmware = autopilot_place.make(here.roles()).firmware;
  firmware.start();
  here.start_watchdog();
  for (;;) {
    firmware.run();
    boards::glance(firmware, board_glance);
    here.idle();
  }
}
}
