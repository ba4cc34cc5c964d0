// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/xml.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <string>

#include "config/strict_yaml.hpp"

namespace rosflight::sim::world {
namespace {

class Converter {
 public:
  explicit Converter(const std::string& file) : file_{file} {}

  [[noreturn]] void fail(int line, const std::string& found, const std::string& allowed) const {
    throw config::Error(file_ + ":" + std::to_string(line) + ": found " + found + ", allowed " +
                        allowed);
  }

  /// A document type: its entities are not known here.
  void refuse_unknown(const tinyxml2::XMLNode& node) const {
    if (const auto* unknown = node.ToUnknown())
      fail(unknown->GetLineNum(), "'<!" + std::string(unknown->Value()) + ">'",
           "elements and comments");
  }

  XmlElement element(const tinyxml2::XMLElement& from) const {
    XmlElement made;
    made.name = from.Name();
    made.line = from.GetLineNum();
    for (const auto* one = from.FirstAttribute(); one != nullptr; one = one->Next())
      made.attributes.emplace(one->Name(), one->Value());
    for (const auto* node = from.FirstChild(); node != nullptr; node = node->NextSibling()) {
      refuse_unknown(*node);
      if (const auto* inner = node->ToElement()) made.children.push_back(element(*inner));
      if (const auto* text = node->ToText()) made.text += text->Value();
    }
    trim(made.text);
    return made;
  }

 private:
  static void trim(std::string& text) {
    constexpr const char* kBlanks = " \t\n\r";
    text.erase(text.find_last_not_of(kBlanks) + 1);
    text.erase(0, text.find_first_not_of(kBlanks));
  }

  const std::string& file_;
};

}  // namespace

const XmlElement* XmlElement::child(std::string_view wanted) const {
  for (const XmlElement& one : children)
    if (one.name == wanted) return &one;
  return nullptr;
}

XmlElement read_xml(std::string_view text, const std::string& file) {
  const Converter converter{file};
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    converter.fail(std::max(document.ErrorLineNum(), 1),
                   std::string("no well-formed XML (") + document.ErrorName() + ")",
                   "XML 1.0 in UTF-8");
  const tinyxml2::XMLElement* root = nullptr;
  for (const auto* node = document.FirstChild(); node != nullptr; node = node->NextSibling()) {
    converter.refuse_unknown(*node);
    if (node->ToElement() == nullptr && node->ToText() == nullptr) continue;
    if (root != nullptr || node->ToText() != nullptr)
      converter.fail(node->GetLineNum(), "more than one root element", "one");
    root = node->ToElement();
  }
  if (root == nullptr) converter.fail(1, "no element", "one");
  return converter.element(*root);
}

}  // namespace rosflight::sim::world
