// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "sim/registry.hpp"

namespace rosflight::sim::sensors {

/// Adds the sensors module of this folder, "standard".
void register_sensors(Registry& registry);

/// The module that `module` in the section `sensors` of the vehicle file names, "standard" if it
/// names none.
/// @throws config::Error  unknown name, or whatever the module finds wrong in its section.
std::unique_ptr<SensorsModule> make_sensors(const Registry& registry, const Vehicle& vehicle,
                                            const RandomSource& random);

/// The same for a board whose parts are modelled: the standard module as exposure() has it. Another module keeps
/// its own times.
std::unique_ptr<SensorsModule> make_exposure(const Registry& registry, const Vehicle& vehicle,
                                             const RandomSource& random, Time imu_period,
                                             Time period);

}  // namespace rosflight::sim::sensors
