// SPDX-License-Identifier: BSD-3-Clause
#include "config/node.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "config/strict_yaml.hpp"

namespace rosflight::config::detail {
namespace {

constexpr int kMaxDepth = 32;
constexpr std::size_t kMaxNodes = 100'000;  // an alias bomb ends here

bool is_control(char c) {
  const auto u = static_cast<unsigned char>(c);
  return u < 0x20U || u == 0x7FU;
}

class Builder {
 public:
  explicit Builder(const Origin& origin) : origin_{origin} {}

  std::unique_ptr<Node> build(const YAML::Node& yaml, const std::string& path, int line,
                              int depth) {
    auto node = std::make_unique<Node>();
    node->path = path;
    node->where = place(line);
    node->directory = origin_.directory;
    if (depth > kMaxDepth || ++nodes_ > kMaxNodes) {
      throw fault(
          line, path, "too deep or too large a tree",
          std::to_string(kMaxDepth) + " levels and " + std::to_string(kMaxNodes) + " values");
    }
    const std::string& tag = yaml.Tag();
    if (!tag.empty() && tag != "?" && tag != "!") {
      throw fault(line, path, "the tag " + printable(tag), "no tags");
    }
    if (yaml.IsScalar()) {
      node->kind = NodeKind::kScalar;
      node->scalar = yaml.Scalar();
      node->quoted = tag == "!";
    } else if (yaml.IsSequence()) {
      node->kind = NodeKind::kList;
      build_list(yaml, *node, line, depth);
    } else if (yaml.IsMap()) {
      node->kind = NodeKind::kMap;
      build_map(yaml, *node, line, depth);
    }
    return node;
  }

  Error fault(int line, const std::string& path, const std::string& found,
              const std::string& allowed) const {
    return Error(place(line) + ": " + (path.empty() ? "" : path + ": ") + "found " + found +
                 ", allowed " + allowed);
  }

 private:
  std::string place(int line) const {
    return origin_.with_lines ? origin_.name + ":" + std::to_string(line) : origin_.name;
  }

  static int line_of(const YAML::Node& yaml, int otherwise) {
    return yaml.Mark().is_null() ? otherwise : yaml.Mark().line + 1;
  }

  void build_list(const YAML::Node& yaml, Node& node, int line, int depth) {
    for (std::size_t i = 0; i < yaml.size(); ++i) {
      const std::string name = std::to_string(i);
      auto child = build(yaml[i], join(node.path, name), line_of(yaml[i], line), depth + 1);
      child->key = name;
      node.children.push_back(std::move(child));
    }
  }

  void build_map(const YAML::Node& yaml, Node& node, int line, int depth) {
    std::map<std::string, int> first_line;
    for (const auto& entry : yaml) {
      const int key_line = line_of(entry.first, line);
      if (!entry.first.IsScalar())
        throw fault(key_line, node.path, "a key that is no word", "words");
      const std::string& key = entry.first.Scalar();
      const std::string path = join(node.path, printable(key));
      if (!is_key(key)) {
        throw fault(key_line, path, "the key \"" + printable(key) + "\"", std::string(kKeys));
      }
      const auto [first, is_new] = first_line.emplace(key, key_line);
      if (!is_new) {
        throw fault(key_line, path,
                    "the key again (first in line " + std::to_string(first->second) + ")",
                    "each key once");
      }
      auto child = build(entry.second, path, key_line, depth + 1);
      child->key = key;
      node.children.push_back(std::move(child));
    }
  }

  static std::string join(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
  }

  const Origin& origin_;
  std::size_t nodes_{0};
};

class DocumentStarts final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { position = mark.pos; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {}
  void OnSequenceStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/, YAML::EmitterStyle::value /*style*/) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {}
  void OnMapEnd() override {}

  int position{-1};
};

/// YAML::LoadAll of yaml-cpp 0.7 never ends on "a: 1\n,": it finds documents without eating a byte.
std::size_t count_documents(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStarts starts;
  std::size_t count = 0;
  int before = -1;
  while (parser.HandleNextDocument(starts)) {
    ++count;
    if (count > 1 && starts.position <= before) break;
    before = starts.position;
  }
  return count;
}

void check_text(std::string_view text, const Builder& builder) {
  int line = 1;
  for (const char c : text) {
    if (c == '\n') ++line;
    if (is_control(c) && c != '\n' && c != '\t' && c != '\r') {
      throw builder.fault(line, "", "a control character (is this a binary file?)", "YAML text");
    }
  }
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (is_control(c)) {
      constexpr std::string_view kHex = "0123456789abcdef";
      const auto u = static_cast<unsigned char>(c);
      out += "\\x";
      out += kHex[u >> 4U];
      out += kHex[u & 0xFU];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

/// A plain scalar that YAML reads back as itself inside flow and block context.
bool plain(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(),
                     [](char c) {
                       return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                              (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '+' ||
                              c == '/' || c == '-';
                     }) &&
         text != "-" && text != "." && text.substr(0, 3) != "---" && text != "null" &&
         text != "Null" && text != "NULL";
}

std::string scalar_text(const Node& node) {
  if (node.kind == NodeKind::kNull) return "null";
  return node.quoted || !plain(node.scalar) ? quoted(node.scalar) : node.scalar;
}

bool all_leaves(const Node& node) {
  return std::all_of(node.children.begin(), node.children.end(), [](const auto& child) {
    return child->kind == NodeKind::kScalar || child->kind == NodeKind::kNull;
  });
}

std::string key_text(const std::string& key) {
  return plain(key) ? key : quoted(key);
}

void emit_value(const Node& node, const std::string& indent, std::string& out);

void emit_children(const Node& node, const std::string& indent, std::string& out) {
  for (const auto& child : node.children) {
    out += indent + (node.kind == NodeKind::kMap ? key_text(child->key) + ":" : "-");
    emit_value(*child, indent + "  ", out);
  }
}

void emit_value(const Node& node, const std::string& indent, std::string& out) {
  const bool is_map = node.kind == NodeKind::kMap;
  if (node.kind == NodeKind::kScalar || node.kind == NodeKind::kNull) {
    out += ' ';
    out += scalar_text(node);
    out += '\n';
  } else if (node.children.empty()) {
    out += is_map ? " {}\n" : " []\n";
  } else if (!is_map && all_leaves(node)) {
    out += " [";
    for (std::size_t i = 0; i < node.children.size(); ++i) {
      if (i != 0) out += ", ";
      out += scalar_text(*node.children[i]);
    }
    out += "]\n";
  } else {
    out += '\n';
    emit_children(node, indent, out);
  }
}

}  // namespace

Node* Node::child(std::string_view name) const {
  const auto found = std::find_if(children.begin(), children.end(),
                                  [name](const auto& candidate) { return candidate->key == name; });
  return found == children.end() ? nullptr : found->get();
}

std::unique_ptr<Node> Node::copy() const {
  auto twin = std::make_unique<Node>();
  twin->kind = kind;
  twin->key = key;
  twin->path = path;
  twin->where = where;
  twin->directory = directory;
  twin->scalar = scalar;
  twin->quoted = quoted;
  for (const auto& child : children) twin->children.push_back(child->copy());
  return twin;
}

std::string Node::shown() const {
  switch (kind) {
    case NodeKind::kScalar:
      return quoted ? std::string(1, '"') + printable(scalar) + '"' : printable(scalar);
    case NodeKind::kList:
      return "a list of " + std::to_string(children.size());
    case NodeKind::kMap:
      return "a map";
    case NodeKind::kNull:
      break;
  }
  return "nothing";
}

std::unique_ptr<Node> parse(std::string_view text, const Origin& origin, const std::string& prefix,
                            int depth) {
  Builder builder(origin);
  check_text(text, builder);
  try {
    const std::string owned(text);
    const std::size_t documents = count_documents(owned);
    if (documents > 1) {
      throw builder.fault(1, prefix, std::to_string(documents) + " documents", "one");
    }
    return builder.build(YAML::Load(owned), prefix, 1, depth);
  } catch (const YAML::Exception& error) {
    throw builder.fault(error.mark.is_null() ? 1 : error.mark.line + 1, prefix,
                        "broken YAML (" + printable(error.msg) + ")", "well-formed YAML");
  }
}

void merge(Node& base, const Node& over) {
  if (base.kind != NodeKind::kMap || over.kind != NodeKind::kMap) {
    base = std::move(*over.copy());
    return;
  }
  for (const auto& child : over.children) {
    if (Node* same = base.child(child->key)) {
      merge(*same, *child);
    } else {
      base.children.push_back(child->copy());
    }
  }
}

std::string emit(const Node& root) {
  if (root.children.empty()) return root.kind == NodeKind::kList ? "[]\n" : "{}\n";
  std::string out;
  emit_children(root, "", out);
  return out;
}

bool is_key(std::string_view key) {
  constexpr std::size_t kMaxLength = 128;
  return !key.empty() && key.size() <= kMaxLength && key.find('.') == std::string_view::npos &&
         std::none_of(key.begin(), key.end(), is_control);
}

std::string printable(std::string_view text) {
  constexpr std::size_t kMaxLength = 60;
  std::string out;
  for (const char c : text.substr(0, kMaxLength)) out += is_control(c) ? '?' : c;
  return text.size() > kMaxLength ? out + "..." : out;
}

}  // namespace rosflight::config::detail
