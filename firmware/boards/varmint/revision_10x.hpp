// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>

#include "firmware/boards/stm32h7/spi_bus.hpp"

/// Revision 10X of the Varmint: what differs from 11X, whose file has the same names. An image is compiled
/// for one of them. Source: the board's definitions in ROSflight 2.x.
namespace rosflight::boards::varmint {

using stm32h7::Pin;

inline constexpr Pin kRedLed{'E', 7};

/// SPI2 has the magnetometer, SPI3 the barometer; the pin of SPI3's output has a function number of its own.
inline constexpr stm32h7::SpiBus::Pins kSensorBuses[] = {
    {stm32h7::SPI2, {'B', 13}, {'C', 2}, {'C', 3}, 5, 3, 4, stm32h7::request::SPI2_RX},
    {stm32h7::SPI3, {'B', 3}, {'B', 4}, {'B', 2}, 6, 1, 2, stm32h7::request::SPI3_RX, 7}};
inline constexpr std::size_t kMagBus = 0, kBaroBus = 1;

/// The supply of the servos is fixed.
inline constexpr bool kHasServoSupply = false;

}  // namespace rosflight::boards::varmint
