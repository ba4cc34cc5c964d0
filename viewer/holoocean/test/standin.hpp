// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "viewer/holoocean/package.hpp"

namespace rosflight::viewer::holoocean {

/// An installed package Land whose program is the stand-in engine; gone with this object.
class StandIn {
 public:
  /// @param options  of standin_engine.py.
  /// @param start  how its script starts it.
  explicit StandIn(const std::string& options = "", const std::string& start = "exec ") {
    std::string pattern = (std::filesystem::temp_directory_path() / "holoocean_XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    const std::filesystem::path package = folder_ / "2.3.0/worlds/Land";
    std::filesystem::create_directories(package);
    std::ofstream(package / "config.json")
        << R"({"name": "Land", "platform": "Linux", "version": "2.3.0", "path": "engine",
               "worlds": [{"name": "Meadow", "pre_start_steps": 2, "env_min": [-5, -5, 0], "env_max": [5, 5, 9.5]},
                          {"name": "Dunes"}]})";
    std::ofstream(package / "engine")
        << "#!/bin/sh\n"
        << start << "python3 '" ROSFLIGHT_HOLOOCEAN_STANDIN "' --record '" << record().string()
        << "' " << options << " -- \"$@\"\n";
    std::filesystem::permissions(package / "engine", std::filesystem::perms::owner_all);
  }
  ~StandIn() { std::filesystem::remove_all(folder_); }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  World world(const Scenario& scenario) const { return find_world(scenario, folder_); }

  /// What it received, in order.
  std::vector<nlohmann::json> events(const std::string& kind) const {
    std::vector<nlohmann::json> found;
    std::ifstream file(record());
    for (std::string line; std::getline(file, line);) {
      auto event = nlohmann::json::parse(line);
      if (event["event"] == kind) found.push_back(std::move(event));
    }
    return found;
  }

 private:
  std::filesystem::path record() const { return folder_ / "record.jsonl"; }
  std::filesystem::path folder_;
};

/// The message of the error that `run` ends with.
template <class Run>
std::string error_of(const Run& run) {
  try {
    run();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

/// Blocks and semaphores of this name that are there.
inline std::vector<std::string> left_of(const std::string& name) {
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    const std::string file = entry.path().filename().string();
    if (file.find(name) != std::string::npos) left.push_back(file);
  }
  return left;
}

}  // namespace rosflight::viewer::holoocean
