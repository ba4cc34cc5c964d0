// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rosflight::sim::world {

/// An element of an XML file with the line that it begins in.
struct XmlElement {
  std::string name;
  int line{};
  std::map<std::string, std::string, std::less<>> attributes;
  std::string text;  ///< That of the element itself, without blanks at both ends.
  std::vector<XmlElement> children;

  /// The first child of this name; nullptr: none.
  const XmlElement* child(std::string_view wanted) const;
};

/// Reads an XML document by tinyxml2, which expands no entities of a document type; such a type is refused.
/// @param file  for messages. @returns the root. @throws config::Error  FILE:LINE: found X, allowed Y.
XmlElement read_xml(std::string_view text, const std::string& file);

}  // namespace rosflight::sim::world
