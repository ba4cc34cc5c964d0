// SPDX-License-Identifier: BSD-3-Clause
// The image: board, link and firmware put together, and the interrupts of the board.
#include "firmware/boards/pixracer_pro/pixracer_pro_board.hpp"
// stm32h7/image_main.hpp, or what tests put in its place.
#include ROSFLIGHT_IMAGE

namespace {

using namespace rosflight::boards::stm32h7;  // NOLINT(google-build-using-namespace): this is their
                                             // main
using rosflight::boards::pixracer_pro::PixracerPro;

Image<PixracerPro> image;
__attribute__((section(".dma"))) PixracerPro::Memory dma_memory;

constexpr Interrupt kInterrupts[] = {
    {irq::EXTI3, [] { image.board().on_imu_ready(); }},
    {irq::SPI5, [] { image.board().on_imu_sample(); }},
    {irq::DMA1_STREAM5, [] { image.board().on_imu_bus(); }},
    {irq::DMA1_STREAM3, [] { image.board().on_baro_bus(); }},
    {irq::I2C1_EV, [] { image.board().on_external_bus(); }},
    {irq::I2C1_ER, [] { image.board().on_external_bus(); }},
    {irq::UART4, [] { image.board().on_gnss(); }},
    {irq::DMA1_STREAM0, [] { image.board().on_gnss_sent(); }},
    {irq::EXTI15_10, [] { image.board().on_pulse_per_second(); }},
    {irq::OTG_FS, [] { image.board().on_usb(); }},
    {irq::USART2, [] { image.board().on_link(); }},
    {irq::DMA2_STREAM0, [] { image.board().on_link_sent(); }},
    {irq::USART6, [] { image.board().on_receiver(); }},
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
  image.run(rosflight::boards::pixracer_pro::kOscillator, dma_memory, board_glance);
}
}
