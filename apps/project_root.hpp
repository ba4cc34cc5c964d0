// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>

namespace rosflight::apps {

/// The folder with vehicles/ and missions/: the nearest one above the running program, else above
/// the current directory. @throws config::Error if there is none.
std::filesystem::path project_root();

}  // namespace rosflight::apps
