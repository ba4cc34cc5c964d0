// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <string>

#include "flight/vehicle/frame.hpp"

namespace rosflight::apps {

struct MixerOptions {
  std::string input;    ///< Frame file of ROSflight 2.x; empty: the vehicle.
  std::string vehicle;  ///< Name of vehicles/ or a vehicle file; empty: the frame file.
  std::string output{"mixing_params.yaml"};
  flight::MixerTarget target{flight::MixerTarget::kPrimary};
  bool append{false};  ///< Add to a file that holds other parameters.
  bool force{false};   ///< Replace a file.
};

/// `./rosflight mixer`: a vehicle or a frame file in, a parameter file out, a check for the reader on `out`.
/// @returns the exit code. @throws config::Error or std::runtime_error, one line; nothing is
/// written then.
int mixer_command(const MixerOptions& options, std::ostream& out);

}  // namespace rosflight::apps
