// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/hal/time.hpp"

namespace rosflight::boards::parts {

/// Signals of a board's buzzer. On the ground it is silent but for the signals of an event:
///
///     event or condition           signal                      tone
///     start after a fault          three short                 2000 Hz
///     armed                        one long                    2500 Hz
///     disarmed                     two short                   2500 Hz
///     failsafe while armed         half of each second         4000 Hz
///     battery low while armed      a tenth of each second      4000 Hz
///
/// An event ends the signal before it. A condition has its signal once the one before is over, failsafe before
/// battery low. Knows no chip: the board makes a square wave of the tone.
class Buzzer {
 public:
  struct Inputs {
    bool armed, failsafe, battery_low;
    bool after_fault;  ///< The board started after a fault; only the first step reads it.
  };

  /// Main loop, once per pass. @returns period of the tone [us]; 0: silent.
  std::uint32_t step(const Inputs& in, hal::Time now);

 private:
  enum class Signal : std::uint8_t { kNone, kStart, kArmed, kDisarmed, kFailsafe, kBatteryLow };
  enum class Seen : std::uint8_t { kNothing, kDisarmed, kArmed };

  Signal signal_{Signal::kNone};
  Seen seen_{Seen::kNothing};  ///< In the last step.
  std::uint32_t begin_us_{0};  ///< When the signal began.
};

}  // namespace rosflight::boards::parts
