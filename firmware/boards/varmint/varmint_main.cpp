// SPDX-License-Identifier: BSD-3-Clause
// The image: board, link and firmware put together, and the interrupts of the board.
#include "firmware/boards/varmint/varmint_board.hpp"
// stm32h7/image_main.hpp, or what tests put in its place.
#include ROSFLIGHT_IMAGE

namespace {

using namespace rosflight::boards::stm32h7;  // NOLINT(google-build-using-namespace): this is their
                                             // main
namespace varmint = rosflight::boards::varmint;
using varmint::Varmint;

Image<Varmint> image;
__attribute__((section(".dma"))) Varmint::Memory dma_memory;

constexpr Interrupt kInterrupts[] = {
    {irq::EXTI9_5, [] { image.board().on_edges(); }},
    {irq::SPI4, [] { image.board().on_imu_sample(); }},
    {irq::SPI2, [] { image.board().on_pitot_ready(); }},
    {irq::DMA1_STREAM5, [] { image.board().on_imu_bus(); }},
    {irq::DMA1_STREAM3, [] { image.board().on_sensor_bus(0); }},
    {irq::DMA1_STREAM1, [] { image.board().on_sensor_bus(varmint::kBaroBus); }},  // revision 10X
    {irq::I2C1_EV, [] { image.board().on_i2c(); }},
    {irq::I2C1_ER, [] { image.board().on_i2c(); }},
    {irq::USART1, [] { image.board().on_gnss(); }},
    {irq::DMA1_STREAM0, [] { image.board().on_gnss_sent(); }},
    {irq::EXTI3, [] { image.board().on_pulse_per_second(); }},
    {irq::OTG_FS, [] { image.board().on_usb(); }},
    {irq::USART2, [] { image.board().on_link(); }},
    {irq::DMA2_STREAM0, [] { image.board().on_link_sent(); }},
    {irq::USART3, [] { image.board().on_receiver(); }},
    {irq::TIM7, [] { image.board().on_tick(); }},
    {irq::TIM6_DAC, board_take_fault},  // the watchdog's warning
};

}  // namespace

extern "C" {

/// For debuggers and for the emulated board, which finds it by its name.
rosflight::boards::FirmwareGlance board_glance;

extern const VectorTable board_vectors;
__attribute__((section(".vectors"), used)) const VectorTable board_vectors =
    make_vectors(kInterrupts);

void board_fault(const FaultRegisters& registers) {
  image.record_fault(registers);
}

[[noreturn]] void board_main() {
  image.run(varmint::kOscillator, dma_memory, board_glance);
}
}
