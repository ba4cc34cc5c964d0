// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <iosfwd>

#include "web/server/access.hpp"

namespace rosflight::viewer {

/// Serves the page with a recorded flight to browsers until Ctrl-C. Prints its address.
/// @param input  flight folder or log. @returns the exit code, 0.
/// @throws config::Error  no such flight, no page, or it cannot listen there.
int view_log(const std::filesystem::path& input, const web::server::Access& access,
             std::ostream& out);

}  // namespace rosflight::viewer
