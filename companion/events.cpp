// SPDX-License-Identifier: BSD-3-Clause
#include "companion/events.hpp"

#include <array>
#include <cstdio>

namespace rosflight::companion {

std::string schema_text(const SchemaEvent& event) {
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(),
                "lean link refused: the FCU's messages are schema %08X, ours %08X; build both from "
                "the same link/messages.hpp",
                static_cast<unsigned>(event.theirs), static_cast<unsigned>(event.ours));
  return line.data();
}

}  // namespace rosflight::companion
