// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "ground/ground_link.hpp"

namespace rosflight::viewer {

/// Another vehicle, whose parameters are only read: a file has them, renewed when one changes.
class OtherVehicle {
 public:
  /// Opens nothing yet. @throws LinkError  the link cannot be read or its host is unknown.
  explicit OtherVehicle(const std::string& link);

  /// Call it once, before the first step. The file has no entries before the vehicle has sent its whole list.
  void set_file(std::filesystem::path file);

  /// Runs its link for a millisecond. @throws LinkError  taken, forbidden, no serial port.
  void step();

 private:
  ground::GroundLink link_;
  std::filesystem::path file_;
  companion::Job<companion::ParameterClient::ListResult> list_;
  bool requested_{false};
  std::optional<std::uint64_t> written_;  ///< Revision in the file.
};

}  // namespace rosflight::viewer
