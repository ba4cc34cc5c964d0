// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "companion/parameter.hpp"

/// Parameter files, as ROSflight 2.x writes and reads them: a YAML list of maps
///
///     - {name: PID_ROLL_RATE_P, type: 9, value: 0.1}
///
/// with type 6 for int32 and 9 for float. Reading is strict: every entry has these three keys and
/// no other, the value fits the type, no name comes twice.
namespace rosflight::companion {

/// The values that are allowed for an entry that is not; nothing for one that is.
using EntryCheck = std::function<std::optional<std::string>(const NamedValue&)>;

/// Throws config::Error with one line that names file, line, key, what was found and what is
/// allowed. @param check  of each value besides its type, with the same error; may be empty.
ParameterSet read_parameter_file(const std::filesystem::path& path, const EntryCheck& check = {});
/// The same for text; `name` stands for the file in messages.
ParameterSet parse_parameters(std::string_view text, const std::string& name);

/// The text of a file, entries sorted by name. Values that are no finite number become a comment.
std::string format_parameters(const ParameterSet& set, std::string_view firmware_version);
/// Writes it beside `path` and moves it there: the old file stays until the new one is whole.
/// Throws std::runtime_error with one line if that fails.
void write_parameter_file(const std::filesystem::path& path, const ParameterSet& set,
                          std::string_view firmware_version);

}  // namespace rosflight::companion
