// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>

#include "base/file_descriptor.hpp"

namespace rosflight::base {

/// A new pseudo terminal: this side, and the name under which a peer opens the other one.
struct PseudoTerminal {
  FileDescriptor master;  ///< Never blocks. Not valid() with errno set if there can be none.
  std::string name;

  static PseudoTerminal open();
};

/// Sets a terminal to bytes as they are, 8N1, without echo and flow control.
/// @param baud  A rate that parse_link() accepts; 0 keeps the present one. @returns false with errno set.
bool make_raw(const FileDescriptor& terminal, std::uint32_t baud = 0);

}  // namespace rosflight::base
