// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>

namespace rosflight::flight {

/// The folder with vehicles/ and missions/: the one that the environment variable ROSFLIGHT_DATA_DIR
/// names, else the nearest one above the shared library that this code is in, such as the Python package,
/// else above the running program, else above the current directory. Above
/// means FOLDER, or FOLDER/share/rosflight as an installation has it.
/// @throws config::Error if there is none.
std::filesystem::path project_root();

}  // namespace rosflight::flight
