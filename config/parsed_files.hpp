// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "config/node.hpp"

namespace rosflight::config::detail {

/// Files that were parsed before: a campaign reads the same ones for each flight, and copying a tree takes a sixteenth of
/// the instructions of parsing it. A tree follows from text, name and directory alone. For several threads. Private to
/// this folder.
class ParsedFiles {
 public:
  /// A copy of the tree of this text; parses it if it is new. @throws Error  as parse().
  std::unique_ptr<Node> tree(std::string_view text, const Origin& origin);

 private:
  static constexpr std::size_t kMost = 32;
  struct File {
    std::string name;
    std::string directory;
    std::string text;
    std::unique_ptr<const Node> root;
  };
  std::mutex mutex_;
  std::vector<File> files_;  ///< The oldest first.
};

}  // namespace rosflight::config::detail
