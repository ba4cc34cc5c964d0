// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>

namespace rosflight::apps {

struct ViewOptions {
  std::filesystem::path input;  ///< Flight folder or log.
  std::uint16_t port{0};        ///< 0: a free one.
};

/// Serves the page with a flight to browsers on this computer until Ctrl-C. Prints its address.
/// @returns the exit code, 0.
/// @throws config::Error  no such flight, no page, or the port is taken.
int view_command(const ViewOptions& options, std::ostream& out);

}  // namespace rosflight::apps
