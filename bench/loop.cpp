// SPDX-License-Identifier: BSD-3-Clause
// Simulated time over processor time of the default flight: on the truth alone, as `fly --no-log` and
// as `fly` record it, and on the estimate; and of the default fixed wing on the estimate. One
// measurement a run.
//
// Processor time is that of all threads, so that of the log's compression too.
//
// usage: loop [--only-factor]
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "flight/flight_recorder.hpp"

namespace {

using namespace rosflight::flight;  // NOLINT(google-build-using-namespace): a program of one file

double processor_time_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// @param log  file of a recorded flight, empty with LogLevel::kNone; nullptr: nothing is recorded.
double factor(const FlightSetup& setup, const std::filesystem::path* log = nullptr) {
  const auto flight = std::make_unique<Flight>(setup);
  std::unique_ptr<FlightRecorder> recorder;
  if (log != nullptr) {
    recorder = std::make_unique<FlightRecorder>(*flight, *log,
                                                log->empty() ? LogLevel::kNone : LogLevel::kPlot);
  }
  const double start_s = processor_time_s();
  flight->run();
  if (recorder) recorder->close();
  const double took_s = processor_time_s() - start_s;
  return rosflight::sim::to_seconds(flight->now()) / took_s;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool log_too = argc < 2 || std::strcmp(argv[1], "--only-factor") != 0;
    FlightChoice on_truth;
    on_truth.state = "truth";
    const auto setup = std::make_unique<FlightSetup>(on_truth);
    const double plain = factor(*setup);
    double recorded = 0.0;
    double logged = 0.0;
    double estimated = 0.0;
    double of_fixedwing = 0.0;
    if (log_too) {
      const std::filesystem::path folder =
          std::filesystem::temp_directory_path() / "rosflight_bench_loop";
      std::filesystem::create_directories(folder);
      const std::filesystem::path file = folder / "flight.mcap";
      const std::filesystem::path no_log;
      recorded = factor(*setup, &no_log);
      logged = factor(*setup, &file);
      std::filesystem::remove_all(folder);
      const auto on_estimate = std::make_unique<FlightSetup>(FlightChoice{});
      estimated = factor(*on_estimate);
      FlightChoice fixedwing;
      fixedwing.vehicle = "anaconda";
      of_fixedwing = factor(*std::make_unique<FlightSetup>(fixedwing));
    }
    std::cout << nlohmann::ordered_json{{"realtime_factor", plain},
                                        {"realtime_factor_no_log", recorded},
                                        {"realtime_factor_log", logged},
                                        {"realtime_factor_ekf", estimated},
                                        {"realtime_factor_fixedwing", of_fixedwing}}
              << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "loop: %s\n", e.what());
    return 1;
  }
}
