// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>

#include "companion/parameter_file.hpp"
#include "firmware/core/parameters.hpp"
#include "flight/vehicle/vehicle_setup.hpp"

namespace {

using rosflight::companion::ParameterSet;
using rosflight::companion::ParameterValue;
namespace core = rosflight::core;

/// Entries of the mixing matrices: the firmware itself fills them in when a mixer is chosen.
bool is_mixer_entry(const std::string& name) {
  return name.rfind("PRI_MIXER_", 0) == 0 || name.rfind("SEC_MIXER_", 0) == 0;
}

/// The parameters of the firmware: what the vehicle file says, defaults for the rest, so that
/// nothing of another vehicle stays behind.
ParameterSet whole_set(const std::string& vehicle_file) {
  const auto vehicle = rosflight::sim::Vehicle::from_file(vehicle_file);
  ParameterSet set = rosflight::flight::read_firmware_parameters(vehicle);
  const std::size_t given = set.size();
  for (std::size_t index = 0; index < core::kParamCount; ++index) {
    const core::ParamRow& row = core::Parameters::row(static_cast<core::Param>(index));
    const std::string name(row.name.data(), ::strnlen(row.name.data(), row.name.size()));
    bool known = is_mixer_entry(name);
    for (std::size_t k = 0; k < given; ++k) known = known || set[k].name == name;
    if (known) continue;
    const bool whole = row.type == rosflight::link::ParamType::kInt32;
    set.push_back(
        {name, whole ? ParameterValue::of(row.initial.i) : ParameterValue::of(row.initial.f)});
  }
  return set;
}

}  // namespace

/// Writes the firmware parameters of a vehicle file as a parameter file. init_firmware calls it.
int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr,
                 "vehicle_firmware: found %d arguments, allowed VEHICLE_FILE PARAMETER_FILE\n",
                 argc - 1);
    return 2;
  }
  try {
    rosflight::companion::write_parameter_file(argv[2], whole_set(argv[1]), "");
  } catch (const std::exception& why) {
    std::fprintf(stderr, "vehicle_firmware: %s\n", why.what());
    return 2;
  }
  return 0;
}
