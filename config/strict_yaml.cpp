// SPDX-License-Identifier: BSD-3-Clause
#include "config/strict_yaml.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "config/node.hpp"
#include "config/parsed_files.hpp"

namespace rosflight::config {
namespace {

using detail::Node;
using detail::NodeKind;

Error fault(const Node& node, const std::string& path, const std::string& found,
            const std::string& allowed) {
  return Error(node.where + ": " + (path.empty() ? "" : path + ": ") + "found " + found +
               ", allowed " + allowed);
}

Error fault(const Node& node, const std::string& allowed) {
  return fault(node, node.path, node.shown(), allowed);
}

std::string join(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

double checked_number(const Node& node, const Range& allowed) {
  if (node.kind != NodeKind::kScalar || node.quoted) throw fault(node, allowed.text());
  const auto value = parse_number(node.scalar);
  if (!value || !allowed.contains(*value)) throw fault(node, allowed.text());
  return *value;
}

std::string list_text(std::size_t count, const Range& allowed) {
  const bool any = count == Section::kAnyCount;
  return "a list of " + (any ? "" : std::to_string(count) + " ") + "numbers, each " +
         allowed.text();
}

std::vector<double> checked_list(const Node& node, std::size_t count, const Range& allowed) {
  const bool wrong_count = count != Section::kAnyCount && node.children.size() != count;
  if (node.kind != NodeKind::kList || wrong_count) throw fault(node, list_text(count, allowed));
  std::vector<double> values;
  values.reserve(node.children.size());
  for (const auto& child : node.children) values.push_back(checked_number(*child, allowed));
  return values;
}

detail::Origin origin_of(std::string name, const std::filesystem::path& directory) {
  return {.name = std::move(name), .with_lines = true, .directory = directory.string()};
}

std::string listed(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ", ") + word;
  return out.empty() ? "no keys here" : out;
}

void finish_node(const Node& node) {
  for (const auto& child : node.children) {
    if (node.kind == NodeKind::kMap && !child->asked) {
      throw fault(*child, child->path, "an unknown key", listed(node.wanted));
    }
    if (!child->foreign) finish_node(*child);
  }
}

Node* step_into(Node& parent, const std::string& key, const std::string& where) {
  if (parent.kind == NodeKind::kNull) parent.kind = NodeKind::kMap;
  if (parent.kind == NodeKind::kScalar) {
    throw Error(where + ": " + join(parent.path, key) + ": found the value " + parent.shown() +
                " at " + parent.path + ", allowed a map or a list");
  }
  if (Node* child = parent.child(key)) return child;
  if (parent.kind == NodeKind::kList) {
    throw Error(where + ": " + join(parent.path, key) + ": found no such entry, allowed one of " +
                std::to_string(parent.children.size()) + " counted from 0");
  }
  auto child = std::make_unique<Node>();
  child->key = key;
  child->path = join(parent.path, key);
  child->where = where;
  child->directory = parent.directory;
  parent.children.push_back(std::move(child));
  return parent.children.back().get();
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto allowed = [](char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
  };
  if (text.empty() || text.front() == '+' || !std::all_of(text.begin(), text.end(), allowed))
    return std::nullopt;
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::string number_text(double x) {
  std::array<char, 32> buffer{};
  const double size = std::abs(x);
  const bool plain = size == 0.0 || (size >= 1e-4 && size < 1e9);
  const auto form = plain ? std::chars_format::fixed : std::chars_format::general;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x, form).ptr;
  return {buffer.data(), end};
}

std::string Range::text() const {
  const bool has_low = std::isfinite(low);
  const bool has_high = std::isfinite(high);
  const std::string from = number_text(low);
  if (has_low && has_high) {
    return low_open ? "a number > " + from + " and <= " + number_text(high)
                    : "a number from " + from + " to " + number_text(high);
  }
  if (has_low) return "a number " + std::string(low_open ? "> " : ">= ") + from;
  if (has_high) return "a number <= " + number_text(high);
  return "a number";
}

Node* Section::find(std::string_view key) const {
  Node* child = node_->child(key);
  if (std::find(node_->wanted.begin(), node_->wanted.end(), key) == node_->wanted.end()) {
    node_->wanted.emplace_back(key);
  }
  if (child != nullptr) child->asked = true;
  return child;
}

const Node& Section::require(std::string_view key, const std::string& allowed) const {
  const Node* child = find(key);
  if (child == nullptr) throw fault(*node_, join(node_->path, key), "nothing", allowed);
  return *child;
}

bool Section::has(std::string_view key) const {
  return find(key) != nullptr;
}

double Section::number(std::string_view key, Range allowed) const {
  return checked_number(require(key, allowed.text()), allowed);
}

double Section::number(std::string_view key, Range allowed, double if_absent) const {
  return has(key) ? number(key, allowed) : if_absent;
}

std::int64_t Section::integer(std::string_view key, std::int64_t low, std::int64_t high) const {
  const std::string allowed =
      "an integer from " + std::to_string(low) + " to " + std::to_string(high);
  const Node& node = require(key, allowed);
  std::int64_t value = 0;
  const char* end = node.scalar.data() + node.scalar.size();
  const bool scalar = node.kind == NodeKind::kScalar && !node.quoted;
  const auto result = std::from_chars(node.scalar.data(), end, value);
  if (!scalar || result.ec != std::errc{} || result.ptr != end || value < low || value > high) {
    throw fault(node, allowed);
  }
  return value;
}

std::int64_t Section::integer(std::string_view key, std::int64_t low, std::int64_t high,
                              std::int64_t if_absent) const {
  return has(key) ? integer(key, low, high) : if_absent;
}

bool Section::boolean(std::string_view key) const {
  // The spellings of YAML 1.2, section 10.3.2; files of ROSflight 2.x have those of Python.
  constexpr std::array<std::string_view, 6> kSpellings{"true",  "True",  "TRUE",
                                                       "false", "False", "FALSE"};
  const Node& node = require(key, "true or false");
  const auto found = std::find(kSpellings.begin(), kSpellings.end(), node.scalar);
  if (node.kind != NodeKind::kScalar || node.quoted || found == kSpellings.end()) {
    throw fault(node, "true or false");
  }
  return found - kSpellings.begin() < 3;
}

bool Section::boolean(std::string_view key, bool if_absent) const {
  return has(key) ? boolean(key) : if_absent;
}

std::string Section::text(std::string_view key) const {
  const Node& node = require(key, "text");
  if (node.kind != NodeKind::kScalar) throw fault(node, "text");
  return node.scalar;
}

std::string Section::text(std::string_view key, std::string_view if_absent) const {
  return has(key) ? text(key) : std::string(if_absent);
}

std::vector<double> Section::numbers(std::string_view key, std::size_t count, Range allowed) const {
  return checked_list(require(key, list_text(count, allowed)), count, allowed);
}

std::vector<std::vector<double>> Section::rows(std::string_view key, std::size_t columns,
                                               Range allowed) const {
  const std::string what = "a list of lists, each " + list_text(columns, allowed);
  const Node& node = require(key, what);
  if (node.kind != NodeKind::kList) throw fault(node, what);
  std::vector<std::vector<double>> all;
  all.reserve(node.children.size());
  for (const auto& child : node.children) all.push_back(checked_list(*child, columns, allowed));
  return all;
}

std::vector<double> Section::numbers(std::string_view key, std::size_t count, Range allowed,
                                     std::vector<double> if_absent) const {
  return has(key) ? numbers(key, count, allowed) : std::move(if_absent);
}

std::size_t Section::choice_index(std::string_view key,
                                  const std::vector<std::string_view>& choices) const {
  std::string allowed;
  for (const auto& choice : choices) allowed += (allowed.empty() ? "" : ", ") + std::string(choice);
  const Node& node = require(key, allowed);
  const auto found = std::find(choices.begin(), choices.end(), node.scalar);
  if (node.kind != NodeKind::kScalar || found == choices.end()) throw fault(node, allowed);
  return static_cast<std::size_t>(found - choices.begin());
}

Section Section::section(std::string_view key) const {
  const Node& node = require(key, "a map");
  if (node.kind != NodeKind::kMap && node.kind != NodeKind::kNull) throw fault(node, "a map");
  return {root_, find(key)};
}

std::optional<Section> Section::optional_section(std::string_view key) const {
  if (!has(key)) return std::nullopt;
  return section(key);
}

Section Section::foreign_section(std::string_view key) const {
  if (!has(key)) step_into(*node_, std::string(key), node_->where)->asked = true;
  find(key)->foreign = true;
  return section(key);
}

std::vector<Section> Section::sections(std::string_view key) const {
  const Node& node = require(key, "a list of maps");
  if (node.kind != NodeKind::kList) throw fault(node, "a list of maps");
  std::vector<Section> all;
  for (const auto& child : node.children) {
    if (child->kind != NodeKind::kMap) throw fault(*child, "a map");
    all.push_back(Section(root_, child.get()));
  }
  return all;
}

std::vector<std::string> Section::keys() const {
  std::vector<std::string> all;
  all.reserve(node_->children.size());
  for (const auto& child : node_->children) all.push_back(child->key);
  return all;
}

void Section::finish() const {
  finish_node(*node_);
}

Error Section::error(std::string_view key, const std::string& found,
                     const std::string& allowed) const {
  const Node* child = node_->child(key);
  return fault(child == nullptr ? *node_ : *child, join(node_->path, key), found, allowed);
}

Error Section::error(const std::string& found, const std::string& allowed) const {
  return fault(*node_, node_->path, found, allowed);
}

std::string Section::raw(std::string_view key) const {
  const Node* child = node_->child(key);
  return child == nullptr ? "nothing" : child->shown();
}

std::filesystem::path Section::directory() const {
  return node_->directory;
}

Document Document::from_file(const std::filesystem::path& file) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status))
    throw Error(file.string() + ": found no such file, allowed a YAML file");
  if (!std::filesystem::is_regular_file(status)) {
    throw Error(file.string() + ": found something that is no file, allowed a YAML file");
  }
  const auto size = std::filesystem::file_size(file, code);
  if (code || size > kMaxBytes) {
    throw Error(file.string() + ": found " + std::to_string(size) + " bytes, allowed " +
                std::to_string(kMaxBytes));
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream && size != 0)
    throw Error(file.string() + ": found a file that cannot be read, allowed a readable one");
  static detail::ParsedFiles parsed;
  return rooted(parsed.tree(text.str(), origin_of(file.string(), file.parent_path())));
}

Document Document::from_text(std::string_view text, std::string name,
                             const std::filesystem::path& directory) {
  return rooted(detail::parse(text, origin_of(std::move(name), directory), "", 0));
}

Document Document::rooted(std::unique_ptr<Node> root) {
  if (root->kind != NodeKind::kMap && root->kind != NodeKind::kList) {
    throw fault(*root, "", root->kind == NodeKind::kNull ? "an empty file" : root->shown(),
                "a map or a list");
  }
  return Document(std::move(root));
}

void Document::set(std::string_view assignment, std::string_view option) {
  const std::string where = std::string(option) + " " + detail::printable(assignment);
  const auto equals = assignment.find('=');
  const std::string_view path = assignment.substr(0, equals);
  if (equals == std::string_view::npos || path.empty()) {
    throw Error(where + ": found no assignment, allowed key.sub=value");
  }
  const std::string prefix = detail::printable(path);
  const detail::Origin origin{.name = where, .with_lines = false, .directory = root_->directory};
  const auto depth = static_cast<int>(std::count(path.begin(), path.end(), '.')) + 1;
  auto value = detail::parse(assignment.substr(equals + 1), origin, prefix, depth);
  if (value->kind == NodeKind::kNull)
    throw Error(where + ": " + prefix + ": found nothing, allowed a value");
  Node* node = root_.get();
  for (std::size_t start = 0; start <= path.size();) {
    const auto dot = std::min(path.find('.', start), path.size());
    const std::string key(path.substr(start, dot - start));
    if (!detail::is_key(key)) {
      throw Error(where + ": found the key \"" + detail::printable(key) + "\", allowed " +
                  std::string(detail::kKeys));
    }
    node = step_into(*node, key, where);
    start = dot + 1;
  }
  value->key = node->key;
  *node = std::move(*value);
}

void Document::merge(const Document& over) {
  detail::merge(*root_, *over.root_);
}

void Document::remove(std::string_view key) {
  std::erase_if(root_->children, [key](const auto& child) { return child->key == key; });
}

Section Document::root() const {
  if (root_->kind != NodeKind::kMap) throw fault(*root_, "a map");
  return {root_, root_.get()};
}

bool Document::is_list() const {
  return root_->kind == NodeKind::kList;
}

std::vector<Section> Document::root_sections() const {
  if (root_->kind != NodeKind::kList) throw fault(*root_, "a list of maps");
  std::vector<Section> all;
  for (const auto& child : root_->children) {
    if (child->kind != NodeKind::kMap) throw fault(*child, "a map");
    all.push_back(Section(root_, child.get()));
  }
  return all;
}

std::string Document::text() const {
  return detail::emit(*root_);
}

}  // namespace rosflight::config
