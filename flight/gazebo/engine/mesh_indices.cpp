// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/engine/mesh_indices.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace rosflight::flight::gazebo {
namespace {

using tinyxml2::XMLElement;

void check_obj(const std::filesystem::path& file, const std::string& where) {
  std::ifstream stream(file);
  long vertices = 0;
  std::size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") ++vertices;
    if (word != "f") continue;
    while (words >> word) {
      const long index = std::strtol(word.c_str(), nullptr, 10);  // 7, 7/8, 7//9 or -1, the last
      if (index != 0 && std::labs(index) <= vertices) continue;
      throw std::runtime_error(where + ": " + file.string() + ":" + std::to_string(number) +
                               ": found a face with vertex " + word + ", allowed 1 to " +
                               std::to_string(vertices));
    }
  }
}

std::string attribute(const XMLElement* element, const char* name) {
  const char* const text = element->Attribute(name);
  return text == nullptr ? "" : text;
}

/// How COLLADA refers to an element. By append(): of "#" + text gcc 12 says at -O3 that its halves overlap (PR 105651).
std::string reference_to(const XMLElement* element) {
  return std::string("#").append(attribute(element, "id"));
}

std::vector<long> whole_numbers(const XMLElement* element) {
  std::istringstream words(
      element == nullptr || element->GetText() == nullptr ? "" : element->GetText());
  std::vector<long> out;
  for (long value = 0; words >> value;) out.push_back(value);
  return out;
}

/// How many items a <source> of COLLADA has: its numbers by the stride of its accessor.
long items_of(const XMLElement* source) {
  const XMLElement* const numbers = source->FirstChildElement("float_array");
  std::istringstream words(
      numbers == nullptr || numbers->GetText() == nullptr ? "" : numbers->GetText());
  long count = 0;
  for (std::string word; words >> word;) ++count;
  const XMLElement* const technique = source->FirstChildElement("technique_common");
  const XMLElement* const accessor =
      technique == nullptr ? nullptr : technique->FirstChildElement("accessor");
  const int stride = accessor == nullptr ? 1 : accessor->IntAttribute("stride", 1);
  return count / std::max(stride, 1);
}

/// Items of each list of a <mesh> by its name with "#".
std::map<std::string, long> lists_of(const XMLElement* mesh) {
  std::map<std::string, long> lists;
  for (auto* e = mesh->FirstChildElement("source"); e != nullptr;
       e = e->NextSiblingElement("source"))
    lists[reference_to(e)] = items_of(e);
  if (const XMLElement* const vertices = mesh->FirstChildElement("vertices")) {
    for (auto* e = vertices->FirstChildElement("input"); e != nullptr;
         e = e->NextSiblingElement("input"))
      if (attribute(e, "semantic") == "POSITION")
        lists[reference_to(vertices)] = lists[attribute(e, "source")];
  }
  return lists;
}

/// @param faces  <triangles> or <polylist>.
void check_faces(const XMLElement* faces, const std::map<std::string, long>& lists,
                 const std::string& what) {
  std::map<std::size_t, std::string> inputs;  // lists by offset
  for (auto* e = faces->FirstChildElement("input"); e != nullptr;
       e = e->NextSiblingElement("input"))
    inputs[static_cast<std::size_t>(std::max(e->IntAttribute("offset"), 0))] =
        attribute(e, "source");
  if (inputs.empty()) return;
  const std::size_t stride = inputs.rbegin()->first + 1;
  const std::vector<long> indices = whole_numbers(faces->FirstChildElement("p"));
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const auto input = inputs.find(k % stride);
    if (input == inputs.end()) continue;
    const auto list = lists.find(input->second);
    const long count = list == lists.end() ? 0 : list->second;
    if (indices[k] >= 0 && indices[k] < count) continue;
    throw std::runtime_error(what + ": found an index " + std::to_string(indices[k]) + " into " +
                             input->second + ", allowed 0 to " + std::to_string(count - 1));
  }
  std::size_t corners = 0;
  for (const long count : whole_numbers(faces->FirstChildElement("vcount")))
    corners += static_cast<std::size_t>(std::max(count, 0L));
  if (corners * stride > indices.size())
    throw std::runtime_error(what + ": found " + std::to_string(indices.size()) +
                             " indices of a polylist, its vcount asks for " +
                             std::to_string(corners * stride));
}

void check_dae(const std::filesystem::path& file, const std::string& where) {
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr)
    return;
  const XMLElement* const library = document.RootElement()->FirstChildElement("library_geometries");
  if (library == nullptr) return;
  for (auto* g = library->FirstChildElement("geometry"); g != nullptr;
       g = g->NextSiblingElement("geometry")) {
    const XMLElement* const mesh = g->FirstChildElement("mesh");
    if (mesh == nullptr) continue;
    const std::map<std::string, long> lists = lists_of(mesh);
    for (const char* kind : {"triangles", "polylist"})
      for (auto* e = mesh->FirstChildElement(kind); e != nullptr; e = e->NextSiblingElement(kind))
        check_faces(e, lists, where + ": " + file.string() + ":" + std::to_string(e->GetLineNum()));
  }
}

}  // namespace

void check_mesh_indices(const std::filesystem::path& file, const std::string& where) {
  const std::string kind = file.extension();
  if (kind == ".obj") check_obj(file, where);
  if (kind == ".dae") check_dae(file, where);
}

}  // namespace rosflight::flight::gazebo
