// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// The tree behind config::Document. Private to this folder.
namespace rosflight::config::detail {

enum class NodeKind { kNull, kScalar, kList, kMap };

struct Node {
  NodeKind kind{NodeKind::kNull};
  std::string key;        ///< In its parent map.
  std::string path;       ///< "body.mass_kg", "rotors.0.spin"; empty at the root.
  std::string where;      ///< "file:12" or "--set a.b=c".
  std::string directory;  ///< Directory of the file.
  std::string scalar;
  bool quoted{false};   ///< Written in quotes: text, never a number.
  bool asked{false};    ///< Somebody knows this key.
  bool foreign{false};  ///< Somebody else finishes it.
  std::vector<std::unique_ptr<Node>> children;
  std::vector<std::string>
      wanted;  ///< Keys asked for in this map, for the message about an unknown one.

  std::unique_ptr<Node> copy() const;
  Node* child(std::string_view name) const;
  /// The value in few words for a message.
  std::string shown() const;
};

/// Where a text comes from.
struct Origin {
  std::string name;       ///< File or option.
  bool with_lines{true};  ///< Append ":LINE".
  std::string directory;
};
/// Parses one document; paths start with `prefix`, which has `depth` parts. Throws config::Error.
std::unique_ptr<Node> parse(std::string_view text, const Origin& origin, const std::string& prefix,
                            int depth);

/// Copies `over` onto `base`: maps key by key, everything else as a whole.
void merge(Node& base, const Node& over);

/// Block-style YAML.
std::string emit(const Node& root);

/// YAML's emitters and readers agree on keys up to 1024 characters, escapes included; a dot would
/// be a path, a control character does not belong into a message.
bool is_key(std::string_view key);
inline constexpr std::string_view kKeys =
    "keys of 1 to 128 characters without dots and control characters";

/// Key or text cut to a length and freed of control characters, for messages.
std::string printable(std::string_view text);

}  // namespace rosflight::config::detail
