// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/engine/sdf_files.hpp"

#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace rosflight::flight::gazebo {
namespace {

namespace fs = std::filesystem;

std::string one_line(const std::string& text) {
  std::istringstream words(text);
  std::string out;
  for (std::string word; words >> word;) out += (out.empty() ? "" : " ") + word;
  return out;
}

/// @param what  stands before the error.
void check(const sdf::Errors& errors, const std::string& what) {
  if (errors.empty()) return;
  const sdf::Error& error = errors.front();
  const auto line = error.LineNumber();
  throw std::runtime_error(what + (line ? ":" + std::to_string(*line) : "") + ": " +
                           one_line(error.Message()));
}

}  // namespace

std::string find_file(const std::string& uri, std::vector<fs::path> folders) {
  std::string path = uri;
  for (const std::string scheme : {"model://", "file://"})
    if (path.starts_with(scheme)) path = path.substr(scheme.size());
  for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH"}) {
    const char* value = std::getenv(variable);
    std::istringstream parts(value == nullptr ? "" : value);
    for (std::string part; std::getline(parts, part, ':');)
      if (!part.empty()) folders.emplace_back(part);
  }
  std::error_code ignored;
  for (const fs::path& from : folders) {
    const fs::path file = (from.empty() ? fs::path(".") : from) / path;
    if (fs::exists(file, ignored)) return file.lexically_normal();
  }
  return {};
}

sdf::Root read_sdf(const fs::path& file) {
  sdf::Console::Instance()->SetQuiet(true);
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored))
    throw std::runtime_error(file.string() + ": found no such file");
  sdf::ParserConfig config;
  config.SetFindCallback(
      [folder = file.parent_path()](const std::string& uri) { return find_file(uri, {folder}); });
  config.SetWarningsPolicy(sdf::EnforcementPolicy::LOG);
  sdf::Root root;
  check(root.Load(file, config), file);
  return root;
}

sdf::Root read_sdf_text(const std::string& text) {
  sdf::Console::Instance()->SetQuiet(true);
  sdf::Root root;
  sdf::Errors errors = root.LoadSdfString(text);
  std::erase_if(errors, [](const sdf::Error& error) {
    return error.Code() == sdf::ErrorCode::LINK_INERTIA_INVALID;
  });
  check(errors, "SDF");
  return root;
}

}  // namespace rosflight::flight::gazebo
