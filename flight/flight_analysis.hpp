// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <string>
#include <vector>

#include "flight/flight.hpp"
#include "flight/gyro_spectrum.hpp"

namespace rosflight::flight {

/// One moment of what follows from a flight and no message of its log has. NaN: not known then.
struct AnalysisMoment {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double t_s{};
  /// Slow error of the satellites, which nothing on board can see: seen position less the true one.
  double drift_north_m{kNone};
  double drift_east_m{kNone};
  // Fixed wing only.
  double cross_track_m{kNone};        ///< Right of the path, less the drift.
  double cross_track_total_m{kNone};  ///< By the truth alone.
  double height_error_m{kNone};       ///< Above the ramped reference.
  double airspeed_command_m_s{kNone};
  double course_command_rad{kNone};
  double aileron{kNone};  ///< By effect, -1..1; so the next two.
  double elevator{kNone};
  double rudder{kNone};
};

AnalysisMoment analysis_moment(const Flight& flight, const sim::Truth& truth);

/// What the page of a flight shows beside its log and its summary: analysis.json of the folder.
struct FlightAnalysis {
  static constexpr double kInterval_s = 0.1;
  std::vector<AnalysisMoment> moments;  ///< Every kInterval_s.
  GyroSpectrum gyro;                    ///< In the air.
};

/// One JSON object: command line, waypoints, parameters that the vehicle changes, curves over time
/// and the spectrum of the gyro.
std::string analysis_json(const FlightSetup& setup, const FlightAnalysis& analysis);

}  // namespace rosflight::flight
