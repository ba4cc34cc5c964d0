// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/log.hpp"
#include "firmware/core/mixer.hpp"
#include "firmware/core/parameters.hpp"

namespace rosflight::core {

/// Sets up the mixers of PRIMARY_MIXER and SECONDARY_MIXER: predefined ones are computed and written
/// back to the PRI_MIXER_... and SEC_MIXER_... parameters, custom ones are read from them; without a
/// secondary the primary is copied. Slow; called at start-up and, disarmed, when the choice changes.
/// @returns false if there is no primary mixer: arming is then impossible.
bool choose_mixers(Parameters& parameters, Mixer& mixer, Log& log);

/// Copies changed PRI_MIXER_... and SEC_MIXER_... parameters into the mixer; without a secondary
/// mixer of its own, SEC follows PRI. @returns true if the kind or pulse rate of a channel changed.
bool take_mixer_changes(const Parameters::ChangeSet& changed, Parameters& parameters, Mixer& mixer);

/// Pulse rates for the board: a channel of type GPIO is a level and has none, whatever its parameter; an unset rate
/// (0) of any other means 50 Hz.
hal::OutputRates output_rates(const MixerHeader& header);

}  // namespace rosflight::core
