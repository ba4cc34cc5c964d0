// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>
#include <string_view>

#include "log/log_extract.hpp"

namespace rosflight::flight {

/// report.html of a flight folder: the page of web/ with the flight inside, which opens from the disk.
/// Its data are every event and each state at the rate of log::LogExtract; the log has all of it.
class FlightPage {
 public:
  /// The page as it was built, without a flight; empty if nobody built it (./rosflight view does).
  static std::filesystem::path built();

  /// @param page   as of built(), not empty.
  /// @param facts  of the log. @throws log::LogError  the folder cannot be written to.
  FlightPage(std::filesystem::path page, std::filesystem::path folder, const log::TextMap& facts);
  /// Leaves no file of its own but report.html.
  ~FlightPage();
  FlightPage(const FlightPage&) = delete;
  FlightPage& operator=(const FlightPage&) = delete;

  log::LogObserver& observer() { return *extract_; }

  /// Writes report.html; call it once, when the log is closed.
  /// @param summary, analysis  JSON. @throws base::FileError, log::LogError, std::runtime_error  the
  /// page is none that a flight can be put into.
  void write(std::string_view summary, std::string_view analysis);

 private:
  std::filesystem::path page_;
  std::filesystem::path folder_;
  std::filesystem::path data_;  ///< The extract, until it is in the page.
  std::unique_ptr<log::LogExtract> extract_;
};

}  // namespace rosflight::flight
