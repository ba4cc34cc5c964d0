// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "log/byte_buffer.hpp"

namespace rosflight::log {

/// As a file of RFC 1952, which browsers unpack by themselves. @throws LogError  no memory.
std::string gzip(Bytes bytes);

}  // namespace rosflight::log
