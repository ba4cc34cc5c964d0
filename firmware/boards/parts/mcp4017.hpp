// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/periodic.hpp"

namespace rosflight::boards::parts {

/// Microchip MCP4017 digital potentiometer on I2C at 0x2F, which sets a servo supply of 4.8 to 8.2 V. The
/// wiper is written, read back, and read again once per second: a part that lost its power comes up in
/// the middle, and is written again.
///
///     n = ((-0.82601912 v + 21.03465037) v - 193.55466392) v + 628.13007632, 0..93              (1)
///
/// Source: (1) fits the divider of the Varmint 11X, as ROSflight 2.x has it.
class Mcp4017 final : public Driver, private TransferOwner {
 public:
  static constexpr std::uint8_t kAddress = 0x2F;

  /// @param supply_V  limited to 4.8..8.2.
  Mcp4017(Port& port, float supply_V);
  /// Equation (1), rounded.
  static std::uint8_t wiper(float supply_V);

 private:
  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;
  void exchange(std::size_t out, std::size_t in);

  Port& port_;
  Periodic period_;
  std::uint8_t wanted_;
  std::uint8_t found_{0};
  bool on_bus_{false};
  bool written_{false};
  Transfer transfer_{};
};

}  // namespace rosflight::boards::parts
