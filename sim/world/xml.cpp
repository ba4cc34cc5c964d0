// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/xml.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "config/strict_yaml.hpp"

namespace rosflight::sim::world {
namespace {

constexpr int kMaxNesting = 64;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}
bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.' || c == ':';
}

std::string trimmed(const std::string& text) {
  std::size_t first = 0;
  std::size_t last = text.size();
  while (first < last && is_blank(text[first])) ++first;
  while (last > first && is_blank(text[last - 1])) --last;
  return text.substr(first, last - first);
}

class XmlReader {
 public:
  XmlReader(std::string_view text, const std::string& file) : text_{text}, file_{file} {}

  XmlElement document() {
    skip("\xEF\xBB\xBF");
    between_elements();
    if (!looking_at("<")) fail(shown(), "an element");
    XmlElement root = element(0);
    between_elements();
    if (at_ < text_.size()) fail(shown(), "nothing after the root element");
    return root;
  }

 private:
  [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
    throw config::Error(file_ + ":" + std::to_string(line_) + ": found " + found + ", allowed " +
                        allowed);
  }
  /// What stands here, for a message.
  std::string shown() const {
    if (at_ >= text_.size()) return "the end of the file";
    const auto c = static_cast<unsigned char>(text_[at_]);
    constexpr unsigned char kFirst = 0x21, kLast = 0x7E;
    return c >= kFirst && c <= kLast ? std::string{"'"} + text_[at_] + "'"
                                     : "character " + std::to_string(c);
  }
  bool looking_at(std::string_view what) const { return text_.substr(at_).starts_with(what); }
  bool skip(std::string_view what) {
    if (!looking_at(what)) return false;
    advance(what.size());
    return true;
  }
  void advance(std::size_t count) {
    const std::string_view passed = text_.substr(at_, count);
    line_ += static_cast<int>(std::count(passed.begin(), passed.end(), '\n'));
    at_ += passed.size();
  }
  void blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) advance(1);
  }
  /// Everything up to `end`, which is passed.
  std::string_view up_to(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos)
      fail("no end of what begins here", "'" + std::string(end) + "'");
    const std::string_view inside = text_.substr(at_, found - at_);
    advance(inside.size() + end.size());
    return inside;
  }
  void between_elements() {
    for (;;) {
      blanks();
      if (skip("<!--")) {
        up_to("-->");
      } else if (skip("<?")) {
        up_to("?>");
      } else {
        return;
      }
    }
  }
  std::string name() {
    const std::size_t first = at_;
    while (at_ < text_.size() && is_name(text_[at_])) ++at_;
    if (at_ == first) fail(shown(), "a name");
    return std::string(text_.substr(first, at_ - first));
  }
  void entity(std::string& out) {
    constexpr std::array<std::pair<std::string_view, char>, 5> kNamed{
        {{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}}};
    const std::string_view inside = up_to(";");
    for (const auto& [word, character] : kNamed) {
      if (inside == word) {
        out += character;
        return;
      }
    }
    constexpr int kHexadecimal = 16, kDecimal = 10, kLastAscii = 127;
    const bool hexadecimal = inside.starts_with("#x");
    const std::string_view digits =
        inside.starts_with("#") ? inside.substr(hexadecimal ? 2 : 1) : std::string_view{};
    int code = 0;
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), code,
                                        hexadecimal ? kHexadecimal : kDecimal);
    if (digits.empty() || result.ptr != digits.data() + digits.size() || code < 1 ||
        code > kLastAscii) {
      fail("an entity that is not known", "amp, lt, gt, quot, apos or a number from 1 to 127");
    }
    out += static_cast<char>(code);
  }
  std::string attribute() {
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    if (quote != '"' && quote != '\'') fail(shown(), "a value in quotes");
    advance(1);
    std::string value;
    while (at_ < text_.size() && text_[at_] != quote) {
      if (skip("&")) {
        entity(value);
        continue;
      }
      if (text_[at_] == '<') fail("'<'", "a value in quotes");
      value += text_[at_];
      advance(1);
    }
    if (at_ == text_.size()) fail(shown(), "a quote");
    advance(1);
    return value;
  }
  XmlElement element(int depth) {
    if (depth == kMaxNesting)
      fail("elements deeper than " + std::to_string(kMaxNesting), "a flatter file");
    XmlElement out;
    out.line = line_;
    advance(1);
    if (looking_at("!")) fail("'<!'", "elements and comments");
    out.name = name();
    for (;;) {
      blanks();
      if (skip("/>")) return out;
      if (skip(">")) break;
      const std::string key = name();
      blanks();
      if (!skip("=")) fail(shown(), "'=' after the attribute " + key);
      blanks();
      if (!out.attributes.emplace(key, attribute()).second)
        fail("the attribute " + key + " twice", "once");
    }
    content(out, depth);
    out.text = trimmed(out.text);
    return out;
  }
  void content(XmlElement& out, int depth) {
    for (;;) {
      if (at_ >= text_.size()) fail(shown(), "</" + out.name + ">");
      if (skip("<!--")) {
        up_to("-->");
      } else if (skip("<![CDATA[")) {
        out.text += up_to("]]>");
      } else if (skip("<?")) {
        up_to("?>");
      } else if (skip("</")) {
        const std::string closed = name();
        if (closed != out.name) fail("</" + closed + ">", "</" + out.name + ">");
        blanks();
        if (!skip(">")) fail(shown(), "'>'");
        return;
      } else if (looking_at("<")) {
        out.children.push_back(element(depth + 1));
      } else if (skip("&")) {
        entity(out.text);
      } else {
        out.text += text_[at_];
        advance(1);
      }
    }
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_{0};
  int line_{1};
};

}  // namespace

const XmlElement* XmlElement::child(std::string_view wanted) const {
  const auto found = std::find_if(children.begin(), children.end(),
                                  [wanted](const XmlElement& one) { return one.name == wanted; });
  return found == children.end() ? nullptr : &*found;
}

XmlElement read_xml(std::string_view text, const std::string& file) {
  return XmlReader(text, file).document();
}

}  // namespace rosflight::sim::world
