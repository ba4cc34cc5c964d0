// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>

#include "firmware/boards/stm32h7/spi_bus.hpp"

/// Revision 11X of the Varmint: what differs from 10X, whose file has the same names. An image is compiled
/// for one of them. Source: the board's definitions in ROSflight 2.x.
namespace rosflight::boards::varmint {

using stm32h7::Pin;

inline constexpr Pin kRedLed{'B', 2};

/// The two chips share SPI2.
inline constexpr stm32h7::SpiBus::Pins kSensorBuses[] = {
    {stm32h7::SPI2, {'B', 13}, {'C', 2}, {'C', 3}, 5, 3, 4, stm32h7::request::SPI2_RX}};
inline constexpr std::size_t kMagBus = 0, kBaroBus = 0;

/// A potentiometer at the I2C sets the supply of the servos.
inline constexpr bool kHasServoSupply = true;

}  // namespace rosflight::boards::varmint
