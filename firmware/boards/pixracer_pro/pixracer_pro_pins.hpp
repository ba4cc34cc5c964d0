// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iterator>

#include "firmware/boards/stm32h7/clocks.hpp"
#include "firmware/boards/stm32h7/flight_board.hpp"
#include "firmware/boards/stm32h7/i2c_bus.hpp"
#include "firmware/boards/stm32h7/spi_bus.hpp"

/// Pins, streams and devices of the mRo Pixracer Pro (M10064, STM32H743IIK6). Sources: the board's
/// definitions in ROSflight 2.x, ArduPilot (mRoPixracerPro) and PX4 (mro/pixracerpro), which agree on
/// all of these.
namespace rosflight::boards::pixracer_pro {

using stm32h7::Pin;

inline constexpr stm32h7::Oscillator kOscillator{24, false};  ///< A crystal.

// Supplies of the sensors: 3.3 V, and the level shifters of 1.8 V. High is on.
inline constexpr Pin kSensorSupply{'E', 3}, kLevelShifter{'I', 3};

// LEDs on open drains: low is lit.
inline constexpr Pin kRedLed{'B', 11}, kGreenLed{'B', 1}, kBlueLed{'B', 3};

// The BMI088 on SPI5. Its gyro announces each sample with a rising edge on INT3.
inline constexpr Pin kGyroReady{'F', 3};
inline constexpr stm32h7::SpiBus::Pins kImuBus{
    stm32h7::SPI5, {'F', 7}, {'F', 8}, {'F', 9}, 5, 5, 6, stm32h7::request::SPI5_RX};
enum ImuDevice : std::uint8_t { kAccel = 0, kGyro = 1 };
/// The part allows 10 MHz; of 64 MHz that leaves 8.
inline constexpr stm32h7::SpiBus::Device kImuDevices[] = {{{'F', 6}, 10'000'000},
                                                          {{'F', 10}, 10'000'000}};

/// The DPS310 shares SPI2 with the FRAM; it has no data-ready line. The FRAM allows 40 MHz; 16 leave room
/// for the wiring.
inline constexpr stm32h7::SpiBus::Pins kBaroBus{
    stm32h7::SPI2, {'B', 10}, {'B', 14}, {'B', 15}, 5, 3, 4, stm32h7::request::SPI2_RX};
enum BaroBusDevice : std::uint8_t { kBaro = 0, kFram = 1 };
inline constexpr stm32h7::SpiBus::Device kBaroBusDevices[] = {{{'D', 7}, 10'000'000},
                                                              {{'D', 10}, 20'000'000}};

/// The only I2C, on the GPS connector: magnetometer and pitot sensor.
inline constexpr stm32h7::I2cBus::Pins kExternalBus{
    stm32h7::I2C1, stm32h7::irq::I2C1_EV, stm32h7::irq::I2C1_ER, {'B', 8}, {'B', 9}, 4};

/// GNSS receiver, and its pulse per second.
inline constexpr stm32h7::Uart::Pins kGnss{
    stm32h7::UART4, stm32h7::irq::UART4, {'A', 1}, {'A', 0}, 8, 7, 0, stm32h7::request::UART4_RX};
inline constexpr Pin kPulsePerSecond{'D', 12};

// Chip selects of parts that are not used yet: kept high.
inline constexpr Pin kUnusedSelects[] = {{'C', 2}, {'E', 15}};

/// Link to the companion: USB, or TELEM 1. Streams 8 and 10 are DMA2's 0 and 2.
inline constexpr stm32h7::Uart::Pins kLink{stm32h7::USART2,
                                           stm32h7::irq::USART2,
                                           {'D', 6},
                                           {'D', 5},
                                           7,
                                           10,
                                           8,
                                           stm32h7::request::USART2_RX};
/// Receiver input; its transmit pin is not connected.
inline constexpr stm32h7::Uart::Pins kReceiver{
    stm32h7::USART6,          stm32h7::irq::USART6,       {'C', 7}, {'C', 6}, 7, 9,
    stm32h7::Uart::kNoStream, stm32h7::request::USART6_RX};

/// A piezo behind a transistor.
inline constexpr Pin kBuzzer{'A', 15};
inline constexpr unsigned kBuzzerFunction = 1;  ///< TIM2 channel 1.

/// Outputs 1 to 8; groups {1-4}, {5, 6}, {7, 8}.
inline constexpr stm32h7::Pulses::Channel kOutputs[] = {
    {stm32h7::TIM1, 3, true, {'E', 14}, 1},  {stm32h7::TIM1, 2, true, {'E', 13}, 1},
    {stm32h7::TIM1, 1, true, {'E', 11}, 1},  {stm32h7::TIM1, 0, true, {'E', 9}, 1},
    {stm32h7::TIM4, 1, false, {'D', 13}, 2}, {stm32h7::TIM4, 2, false, {'D', 14}, 2},
    {stm32h7::TIM8, 0, true, {'I', 5}, 3},   {stm32h7::TIM8, 1, true, {'I', 6}, 3}};

/// Battery: PA2 and PA3. The scales are those of ROSflight 2.x and belong to the power module; for
/// another one there are BATT_VOLT_MULT and BATT_CURR_MULT.
inline constexpr stm32h7::FlightBoard::Plan kPlan{
    {kLink, {'A', 11}, {'A', 12}},
    kReceiver,
    kGnss,
    kPulsePerSecond,
    stm32h7::irq::EXTI15_10,
    kGyroReady,
    stm32h7::irq::EXTI3,
    stm32h7::irq::SPI5,
    {kOutputs,
     std::size(kOutputs),
     {{{stm32h7::TIM1, 11, stm32h7::request::TIM1_UP},
       {stm32h7::TIM4, 12, stm32h7::request::TIM4_UP},
       {stm32h7::TIM8, 13, stm32h7::request::TIM8_UP}}}},
    {kRedLed, kBlueLed, kGreenLed, true},
    {14, 15},
    {12.62f, 0.0f},
    {60.5f, 0.0747f}};

}  // namespace rosflight::boards::pixracer_pro
