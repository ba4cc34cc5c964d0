// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>

namespace rosflight::messages {

/// `text` up to its first NUL as valid UTF-8 (Unicode 15, table 3-7) without control characters:
/// tab and line feed stay, every other offending byte becomes '?'. For texts that come from a link
/// or a file and go where readers refuse anything else: ROS strings, HTML, XML.
std::string clean_utf8(std::string_view text);

}  // namespace rosflight::messages
