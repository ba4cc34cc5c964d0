// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

#include "flight/fly.hpp"
#include "viewer/holoocean/visualiser.hpp"

namespace rosflight::apps {

/// What the options --viewer... of `fly` say.
struct ViewerChoice {
  std::string viewer;  ///< Empty: none.
  std::optional<std::filesystem::path> scenario;
  std::string engine;  ///< Empty: the installed one; kAttach; else the path of its program.
  std::string name;
  std::optional<double> timeout_s;
  bool offscreen{false};

  static constexpr const char* kHoloOcean = "holoocean";
  static constexpr const char* kAttach = "attach";
};

/// HoloOcean beside a flight, from before it until this object ends; then it prints the counts to `err`.
class FlyViewer {
 public:
  /// Starts the engine, waits until it has loaded its world or failed to, and adds it to `options`. In real time the
  /// flight skips states that the engine is too slow for, otherwise it waits for each tick.
  /// @param err  must outlive this. @throws std::exception  bad input, an engine that is missing or has another client.
  FlyViewer(const ViewerChoice& choice, flight::FlyOptions& options, std::ostream& err);
  ~FlyViewer();
  FlyViewer(const FlyViewer&) = delete;
  FlyViewer& operator=(const FlyViewer&) = delete;

  /// The signal that asked the program to stop while the engine loaded; 0: none.
  int stop_signal() const { return stop_signal_; }

 private:
  std::ostream& err_;
  int stop_signal_{0};
  std::optional<viewer::holoocean::Visualiser> visualiser_;
};

}  // namespace rosflight::apps
