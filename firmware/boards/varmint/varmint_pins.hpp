// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iterator>

#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/flight_board.hpp"
#include "firmware/boards/stm32h7/i2c_bus.hpp"
#include "firmware/boards/stm32h7/spi_bus.hpp"
// revision_10x.hpp or revision_11x.hpp.
#include ROSFLIGHT_BOARD_REVISION

/// Pins, streams and devices of the AeroVironment Varmint (STM32H753VIH6): what its revisions have in
/// common. Source: the board's definitions in ROSflight 2.x.
namespace rosflight::boards::varmint {

inline constexpr stm32h7::Oscillator kOscillator{50, true};  ///< A clock, not a crystal.

inline constexpr Pin kGreenLed{'E', 15}, kBlueLed{'E', 8};

// The ADIS16500 on SPI4, paced by a clock that we give. Its reset is low.
inline constexpr Pin kImuReady{'B', 8}, kImuReset{'E', 12}, kSyncClock{'B', 14};
inline constexpr unsigned kSyncClockFunction = 2;  ///< TIM12 channel 1.
inline constexpr stm32h7::SpiBus::Pins kImuBus{
    stm32h7::SPI4, {'E', 2}, {'E', 13}, {'E', 6}, 5, 5, 6, stm32h7::request::SPI4_RX};
inline constexpr stm32h7::SpiBus::Device kImuDevices[] = {{{'E', 4}, 1'000'000}};

/// DPS310 and IIS2MDC, on one bus or two. Each has one wire for both directions: the chip's two data pins
/// meet at the part.
enum BaroBusDevice : std::uint8_t { kBaro = 0, kMag = 1 };
inline constexpr stm32h7::SpiBus::Device kBaroBusDevices[] = {{{'E', 1}, 4'000'000},
                                                              {{'B', 12}, 4'000'000}};

/// Pitot sensor, with a pin that rises at the end of a conversion, and potentiometer of the servo supply.
inline constexpr stm32h7::I2cBus::Pins kI2c{
    stm32h7::I2C1, stm32h7::irq::I2C1_EV, stm32h7::irq::I2C1_ER, {'B', 6}, {'B', 9}, 4};
inline constexpr Pin kPitotReady{'E', 9};
inline constexpr float kServoSupply_V = 4.8f;

inline constexpr stm32h7::Uart::Pins kGnss{stm32h7::USART1,
                                           stm32h7::irq::USART1,
                                           {'B', 7},
                                           {'A', 9},
                                           7,
                                           7,
                                           0,
                                           stm32h7::request::USART1_RX};
inline constexpr Pin kPulsePerSecond{'A', 3};

/// Chip selects of the second IMU, which is not used: kept high.
inline constexpr Pin kUnusedSelects[] = {{'A', 4}, {'D', 10}};

/// Link to the companion: USB, or this. Streams 8 and 10 are DMA2's 0 and 2.
inline constexpr stm32h7::Uart::Pins kLink{stm32h7::USART2,
                                           stm32h7::irq::USART2,
                                           {'D', 6},
                                           {'D', 5},
                                           7,
                                           10,
                                           8,
                                           stm32h7::request::USART2_RX};
inline constexpr stm32h7::Uart::Pins kReceiver{
    stm32h7::USART3,          stm32h7::irq::USART3,       {'D', 9}, {'D', 8}, 7, 9,
    stm32h7::Uart::kNoStream, stm32h7::request::USART3_RX};

/// Outputs 1 to 10; groups {1-4}, {5-8}, {9, 10}.
inline constexpr stm32h7::Pulses::Channel kOutputs[] = {
    {stm32h7::TIM1, 0, true, {'A', 8}, 1},   {stm32h7::TIM1, 1, true, {'E', 11}, 1},
    {stm32h7::TIM1, 2, true, {'A', 10}, 1},  {stm32h7::TIM1, 3, true, {'E', 14}, 1},
    {stm32h7::TIM4, 2, false, {'D', 14}, 2}, {stm32h7::TIM4, 1, false, {'D', 13}, 2},
    {stm32h7::TIM4, 0, false, {'D', 12}, 2}, {stm32h7::TIM4, 3, false, {'D', 15}, 2},
    {stm32h7::TIM3, 0, false, {'C', 6}, 2},  {stm32h7::TIM3, 1, false, {'B', 5}, 2}};

/// Battery: PA0 and PC1.
inline constexpr stm32h7::FlightBoard::Plan kPlan{
    {kLink, {'A', 11}, {'A', 12}},
    kReceiver,
    kGnss,
    kPulsePerSecond,
    stm32h7::irq::EXTI3,
    kImuReady,
    stm32h7::irq::EXTI9_5,
    stm32h7::irq::SPI4,
    {kOutputs,
     std::size(kOutputs),
     {{{stm32h7::TIM1, 11, stm32h7::request::TIM1_UP},
       {stm32h7::TIM4, 12, stm32h7::request::TIM4_UP},
       {stm32h7::TIM3, 13, stm32h7::request::TIM3_UP}}}},
    {kRedLed, kBlueLed, kGreenLed, false},
    {16, 11},
    {11.215f, 0.0f},
    {10.0f, 0.0f}};

}  // namespace rosflight::boards::varmint
