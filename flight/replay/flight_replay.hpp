// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <iosfwd>

#include "flight/replay/csv.hpp"

namespace rosflight::flight {

/// Feeds what the board received in a logged flight to the firmware of this program again, and
/// compares to the bit what it does: every frame that it sends and the outputs of every step. The
/// firmware of the same commit does the same.
///
/// @param log  A log of `fly --log full`; others lack what the sensors gave (/board/inputs).
/// @returns 0 if all is equal, otherwise 1; prints on `out` what was compared, or the first difference.
/// @throws InputError  one line: the log cannot be read, or lacks something.
int replay_flight(const std::filesystem::path& log, std::ostream& out);

}  // namespace rosflight::flight
