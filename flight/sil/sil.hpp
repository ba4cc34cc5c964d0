// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "flight/sil/linux_autopilot.hpp"

/// The firmware as a process in real time, with a simulated vehicle around it, for ground tools.
namespace rosflight::flight {

struct SilOptions {
  std::string vehicle{"multirotor"};  ///< Name in `vehicles_folder` or a file.
  std::filesystem::path vehicles_folder{"vehicles"};
  std::vector<std::string> overrides;          ///< "vehicle.section.key=value" each.
  std::vector<std::filesystem::path> plugins;  ///< Shared libraries with modules of a user's own.
  std::string link{"pty"};                     ///< See base::LinkAddress.
  std::string link_protocol{"mavlink"};        ///< "mavlink" or "lean".
  std::optional<std::uint16_t> listen;         ///< Own port of a UDP link.
  /// Keeps the parameters; default: rosflight_VEHICLE.nvm in the current folder, so that no vehicle flies
  /// with the mixer of another.
  std::optional<std::filesystem::path> storage;
  int rate_Hz{400};  ///< IMU samples and simulation steps a second.
  static constexpr int kMinRate_Hz = 50;
  static constexpr int kMaxRate_Hz = 2000;
  /// Script; without one the pilot leaves all as it is. "-": lines of standard input (RcLines).
  std::optional<std::filesystem::path> rc;
  std::optional<double> duration_s;
  std::vector<std::string> faults;  ///< WHAT@TIME[:DURATION] each.
  std::uint64_t seed{1};
};

/// Runs until SIGINT, SIGTERM or the end of `duration_s`. Writes one line to `out` when the link is
/// open, "sil ready" and key=value words, and a summary to stderr at the end.
/// @returns 0. @throws config::Error, base::LinkError, boards::LinuxError  one line; nothing has
/// been created then, unless a blank memory file.
/// @param make_codec  instead of what `link_protocol` says: measurements put a decorator around it.
int sil_command(const SilOptions& options, std::ostream& out,
                LinuxAutopilot::MakeCodec make_codec = nullptr);

}  // namespace rosflight::flight
