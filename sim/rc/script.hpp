// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "config/strict_yaml.hpp"
#include "sim/rc/pilot.hpp"

namespace rosflight::sim::rc {

/// Reads an RC script, the top level of a file or a section of one:
///
///     rate_Hz: 50                 # frames a second; the period must be whole microseconds
///     channel_count: 8
///     channels: {arm: 4, ...}     # control: channel, -1 for none
///     start: {throttle: 0.0, arm: 0.0, ...}
///     events:
///       - {at_s: 1.0, set: throttle, to: 0.3}
///       - {at_s: 1.0, ramp: throttle, to: 0.5, over_s: 2.0}
///       - {at_s: 1.0, switch: arm, on: true}
///       - {at_s: 1.0, gesture: arm, for_s: 1.5}      # throttle down, yaw right, then centred
///       - {at_s: 8.0, gesture: disarm, for_s: 1.5}   # the same with yaw left
///       - {at_s: 9.0, fault: silence, for_s: 2.0}    # or frame_lost, failsafe
///
/// Everything may be left out. A control is one of kControlNames or channelN, N from 0. Positions
/// are 0..1; -0.5..1.5 is allowed, for a transmitter out of adjustment. Events may stand in any
/// order; at the same time the one written first comes first. Finishes the section. `channels` are
/// the defaults, such as those the vehicle's firmware parameters ask for.
/// @throws config::Error  unknown key or control, control without a channel, wrong type, out of
/// range.
Script read_script(const config::Section& section, const ChannelMap& channels = {});

}  // namespace rosflight::sim::rc
