// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

#include "flight/estimate_record.hpp"
#include "flight/flight.hpp"
#include "flight/gyro_record.hpp"
#include "flight/report/flight_record.hpp"
#include "log/flight_log.hpp"

namespace rosflight::flight {

/// What of a flight goes into its log.
enum class LogLevel : std::uint8_t { kNone, kPlot, kFull };

/// Records a flight: the log on disk and, in memory, what the report shows. Changes nothing.
class FlightRecorder final : public sim::Visualiser, public LinkTap {
 public:
  /// @param flight, observer  must outlive this; without a log nothing is observed.
  /// @throws log::LogError if the log cannot be written.
  FlightRecorder(Flight& flight, const std::filesystem::path& log_file,
                 LogLevel level = LogLevel::kPlot, log::LogObserver* observer = nullptr);

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

  report::FlightRecord& record() { return record_; }
  int warnings() const { return warnings_; }
  int errors() const { return errors_; }
  /// Frames that found the cable's queue full.
  std::uint64_t dropped_frames() const { return dropped_; }

  /// Ends the record; call it once, after the last step. @returns nothing without a log.
  /// @throws log::LogError.
  std::optional<log::LogSummary> close();

 private:
  /// What the report's states are made from.
  using States =
      std::tuple<core::State, bool, bool, std::uint16_t, std::uint16_t, Stage, const char*>;

  void open_log(const std::filesystem::path& file, LogLevel level, log::LogObserver* observer);
  void follow_gyro(const link::Message& message);
  void log_autonomy(sim::Time t);
  void log_parameters(sim::Time t);
  void add_sample(const sim::Truth& truth, const hal::OutputValues& outputs);
  void add_estimate(const sim::Truth& truth, report::Sample& sample);
  void add_route(sim::Time t, const autonomy::fixedwing::FlightManager& manager);
  void follow_states(double t_s);

  Flight& flight_;
  std::unique_ptr<log::FlightLog> log_;  ///< None with LogLevel::kNone.
  report::FlightRecord record_;
  EstimateRecord estimates_;
  GyroRecord gyro_;
  autonomy::StateEstimate estimate_;  ///< Of this sample.
  std::shared_ptr<link::Codec> from_board_;
  std::shared_ptr<link::Codec> from_companion_;
  sim::Time boot_{};
  double last_setpoint_s_{-1.0};
  std::string last_phase_{"disarmed"};
  std::optional<States> states_;  ///< Of the last step.
  bool parameters_logged_{false};
  bool logs_inputs_{false};  ///< All that the board receives.
  int warnings_{0};
  int errors_{0};
  std::uint64_t dropped_{0};
};

}  // namespace rosflight::flight
