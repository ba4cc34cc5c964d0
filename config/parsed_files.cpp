// SPDX-License-Identifier: BSD-3-Clause
#include "config/parsed_files.hpp"

#include <algorithm>

namespace rosflight::config::detail {

std::unique_ptr<Node> ParsedFiles::tree(std::string_view text, const Origin& origin) {
  // A lock that is taken is not waited for: it may be one of a thread that a fork left behind.
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return parse(text, origin, "", 0);
  const auto found = std::ranges::find_if(files_, [&](const File& file) {
    return file.name == origin.name && file.directory == origin.directory && file.text == text;
  });
  if (found != files_.end()) return found->root->copy();
  std::unique_ptr<Node> root = parse(text, origin, "", 0);
  if (files_.size() == kMost) files_.erase(files_.begin());
  files_.push_back({origin.name, origin.directory, std::string(text), root->copy()});
  return root;
}

}  // namespace rosflight::config::detail
