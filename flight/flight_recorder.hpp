// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flight/flight.hpp"
#include "flight/flight_analysis.hpp"
#include "flight/gyro_record.hpp"
#include "log/flight_log.hpp"

namespace rosflight::flight {

/// What of a flight goes into its log.
enum class LogLevel : std::uint8_t { kNone, kPlot, kFull };

/// What the log says of the flight as a whole.
log::TextMap log_facts(const FlightSetup& setup);

/// Records a flight: the log on disk and, in memory, what its page shows beside it. Changes nothing.
class FlightRecorder final : public sim::Visualiser, public LinkTap {
 public:
  /// @param flight, observers  must outlive this; without a log nothing is observed.
  /// @throws log::LogError if the log cannot be written.
  FlightRecorder(Flight& flight, const std::filesystem::path& log_file,
                 LogLevel level = LogLevel::kPlot, std::vector<log::LogObserver*> observers = {});

  void step(const sim::Truth& truth, const hal::OutputValues& outputs) override;
  void on_frame(Direction direction, hal::Time t, const std::uint8_t* data, std::size_t size,
                bool taken) override;
  void on_read(hal::Time t, const std::uint8_t* data, std::size_t size) override {
    if (log_ && logs_inputs_) log_->write_inputs(t, {data, size});
  }
  void on_inputs(hal::Time t, const sim::SensorSamples& samples,
                 const hal::RcFrame* receiver) override {
    if (log_) log_->write_inputs(t, samples, receiver);
  }
  /// Records a note of the mission runner.
  void note(const FlightNote& note);

  /// Complete after close().
  const FlightAnalysis& analysis() const { return analysis_; }
  /// The newest that the firmware sent.
  const std::optional<link::Counters>& counters() const { return counters_; }
  int warnings() const { return warnings_; }
  int errors() const { return errors_; }
  /// Frames that found the cable's queue full.
  std::uint64_t dropped_frames() const { return dropped_; }

  /// Ends the record; call it once, after the last step. @returns nothing without a log.
  /// @throws log::LogError.
  std::optional<log::LogSummary> close();

 private:
  void open_log(const std::filesystem::path& file, LogLevel level,
                std::vector<log::LogObserver*> observers);
  void log_world_sensors();
  void follow_gyro(const link::Message& message);
  void log_autonomy(sim::Time t);
  void log_parameters(sim::Time t);
  void log_route();
  void log_settings(sim::Time t);
  void log_estimate(const sim::Truth& truth);
  void add_route(sim::Time t, const autonomy::fixedwing::FlightManager& manager);

  Flight& flight_;
  std::unique_ptr<log::FlightLog> log_;  ///< None with LogLevel::kNone.
  FlightAnalysis analysis_;
  GyroRecord gyro_;
  std::optional<link::Counters> counters_;
  std::shared_ptr<link::Codec> from_board_;
  std::shared_ptr<link::Codec> from_companion_;
  sim::Time boot_{};
  double last_setpoint_s_{-1.0};
  double last_estimate_s_{-1.0};
  std::string last_phase_{"disarmed"};
  std::string logged_settings_;
  bool parameters_logged_{false};
  bool logs_inputs_{false};  ///< All that the board receives.
  int warnings_{0};
  int errors_{0};
  std::uint64_t dropped_{0};
};

}  // namespace rosflight::flight
