// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "apps/fly/estimate_record.hpp"
#include "apps/fly/flight.hpp"
#include "apps/fly/gyro_record.hpp"
#include "apps/report/flight_record.hpp"
#include "log/flight_log.hpp"

namespace rosflight::apps {

/// Keeps what happens in a flight: the log on disk and, in memory, what the report shows. Looks
/// only.
class FlightRecorder final : public sim::Visualiser, public LinkTap {
 public:
  /// @param log_file  where the log goes. @throws log::LogError if it cannot be made.
  FlightRecorder(Flight& flight, const std::filesystem::path& log_file);

  void step(const sim::Truth& truth, const hal::OutputValues& outputs) override;
  void on_frame(Direction direction, hal::Time t, const std::uint8_t* data, std::size_t size,
                bool taken) override;
  void note(const DirectorNote& note);

  report::FlightRecord& record() { return record_; }
  int warnings() const { return warnings_; }
  int errors() const { return errors_; }
  /// Frames that found the cable's queue full.
  std::uint64_t dropped_frames() const { return dropped_; }

  log::LogSummary close();

 private:
  void follow_gyro(const link::Message& message);
  void log_autonomy(sim::Time t);
  void add_sample(const sim::Truth& truth, const hal::OutputValues& outputs);
  void add_estimate(const sim::Truth& truth, report::Sample& sample);
  void add_route(const autonomy::fixedwing::FlightManager& manager);
  void follow_states(double t_s);

  Flight& flight_;
  std::unique_ptr<log::FlightLog> log_;
  report::FlightRecord record_;
  EstimateRecord estimates_;
  GyroRecord gyro_;
  autonomy::StateEstimate estimate_;  ///< Of this sample.
  std::shared_ptr<link::Codec> from_board_;
  std::shared_ptr<link::Codec> from_companion_;
  sim::Time boot_{};
  double last_setpoint_s_{-1.0};
  std::string last_phase_{"disarmed"};
  int warnings_{0};
  int errors_{0};
  std::uint64_t dropped_{0};
};

}  // namespace rosflight::apps
