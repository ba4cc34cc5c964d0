// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/constants.hpp"
#include "link/messages.hpp"

/// What a report is made from: one flight, kept in memory while it happens. SI, north-east-down and
/// body front-right-down. NaN everywhere means "not known" or "not commanded" and is drawn as a
/// gap.
namespace rosflight::report {

inline constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
inline constexpr std::size_t kMaxMotors = 10;

using Vec3 = std::array<float, 3>;
inline constexpr Vec3 kNoVec3{kNone, kNone, kNone};

/// Of a horizontal vector: north, east.
using Vec2 = std::array<float, 2>;
inline constexpr Vec2 kNoVec2{kNone, kNone};

/// What guidance is told of the vehicle, beside the truth. Errors are estimate less truth.
struct Estimate {
  static constexpr std::size_t kAids = 9;
  static constexpr std::array<std::string_view, kAids> kAidNames{
      "GNSS position", "GNSS height", "GNSS velocity", "barometer", "heading",
      "range",         "pitot",       "sideslip",      "standing"};
  Vec3 p_W_m{kNoVec3};
  Vec3 p_error_m{kNoVec3};       ///< Less what no filter on board can see.
  Vec3 v_error_m_s{kNoVec3};     ///< North, east, down.
  Vec3 turn_error_rad{kNoVec3};  ///< Rotation vector in body axes.
  Vec3 p_sigma_m{kNoVec3};
  Vec3 v_sigma_m_s{kNoVec3};
  Vec3 turn_sigma_rad{kNoVec3};
  Vec2 wind_W_m_s{kNoVec2};
  Vec2 wind_sigma_m_s{kNoVec2};
  float airspeed_m_s{kNone};
  float course_rad{kNone};
  /// Squared innovation over its covariance and degrees of freedom, mean over some seconds: 1 is
  /// right.
  std::array<float, kAids> innovation{kNone, kNone, kNone, kNone, kNone,
                                      kNone, kNone, kNone, kNone};
};

/// What a fixed wing flies by.
struct Wing {
  Vec2 wind_W_m_s{kNoVec2};  ///< True.
  float airspeed_m_s{kNone};
  float airspeed_command_m_s{kNone};
  float course_rad{kNone};
  float course_command_rad{kNone};
  float cross_track_m{kNone};  ///< Positive right of the path, less what no filter can see.
  float cross_track_total_m{kNone};
  float height_error_m{kNone};  ///< Above the ramped reference.
  Vec3 surfaces{kNoVec3};       ///< Aileron, elevator, rudder by effect, -1..1.
};

/// Everything plotted over time, at one instant.
struct Sample {
  double t_s{};
  Vec3 p_W_m{kNoVec3};
  Vec3 v_W_m_s{kNoVec3};
  Vec3 setpoint_W_m{kNoVec3};
  Vec3 attitude_rad{kNoVec3};          ///< True roll, pitch, yaw.
  Vec3 firmware_rad{kNoVec3};          ///< The same as the firmware sees it.
  Vec3 attitude_command_rad{kNoVec3};  ///< Per axis; NaN where rates or torques are commanded.
  Vec3 rates_rad_s{kNoVec3};           ///< True p, q, r.
  Vec3 rate_command_rad_s{kNoVec3};
  std::array<float, kMaxMotors> motors{kNone, kNone, kNone, kNone, kNone,
                                       kNone, kNone, kNone, kNone, kNone};  ///< Outputs, 0..1.
  std::array<float, kMaxMotors> rotors_rad_s{kNone, kNone, kNone, kNone, kNone,
                                             kNone, kNone, kNone, kNone, kNone};
  float battery_V{kNone};
  float battery_A{kNone};
  Estimate estimate{};
  Wing wing{};
};

/// How a state or an event reads: decides its colour and sign.
enum class Tone : std::uint8_t { kNeutral, kGood, kNote, kWarning, kBad };

struct StateChange {
  double t_s{};
  std::string label;  ///< Empty: nothing to show from here on.
  Tone tone{Tone::kNeutral};
};

/// One row of the state timeline; each change holds until the next.
struct Lane {
  std::string name;
  std::vector<StateChange> changes;
};

struct Event {
  double t_s{};
  Tone tone{Tone::kNote};
  std::string source;
  std::string text;
};

struct Waypoint {
  std::array<double, 3> p_W_m{};
  double heading_rad{std::numeric_limits<double>::quiet_NaN()};
  double hold_s{};
  double reached_s{std::numeric_limits<double>::quiet_NaN()};   ///< NaN: missed.
  double truth_m{std::numeric_limits<double>::quiet_NaN()};     ///< Distance it was passed at.
  double estimate_m{std::numeric_limits<double>::quiet_NaN()};  ///< The same by the estimate.
  std::string measure;  ///< Such as "fly-by"; empty: distance from the point.
};

struct Fault {
  std::string what;
  double from_s{};
  double to_s{std::numeric_limits<double>::infinity()};
};

/// One line of the summary. The first few can be shown big.
struct Fact {
  std::string label;
  std::string value;
  std::string unit;
  bool headline{false};
  Tone tone{Tone::kNeutral};
};

struct ChangedParameter {
  std::string name;
  std::string default_value;
  std::string value;
  std::string unit;
};

/// Amplitude densities of the gyro, three axes together [rad/s per square root of Hz], as the
/// sensor gave it and as the firmware's controller takes it.
struct GyroSpectrum {
  std::vector<double> frequency_Hz;
  std::vector<double> before;
  std::vector<double> after;
  double latency_s{std::numeric_limits<double>::quiet_NaN()};  ///< Of slow motion.
};

class FlightRecord {
 public:
  /// @param interval_s  Samples closer than this to the last one kept are dropped; 0 keeps all. A
  /// sample
  ///                    takes some 450 B: at 100 Hz 2.7 MB a minute.
  explicit FlightRecord(double interval_s = 0.01) : interval_s_(interval_s) {}

  /// True if a sample at t_s would be kept: lets a caller save the work of making it.
  bool wants(double t_s) const;
  void add(const Sample& sample);

  /// The state of a lane (made at its first mention) from t_s on; the same state again is not a
  /// change.
  void set_state(std::string_view lane, double t_s, std::string_view label, Tone tone);
  void add_event(double t_s, Tone tone, std::string_view source, std::string_view text);

  const std::vector<Sample>& samples() const { return samples_; }
  const std::vector<Lane>& lanes() const { return lanes_; }
  const std::vector<Event>& events() const { return events_; }
  /// Time of the last thing recorded, at least 0.
  double end_s() const;

  // Filled in directly, at any time before the report is written.
  std::string title{"Flight report"};
  std::string vehicle;
  std::string mission;
  std::string seed;
  std::string command_line;  ///< What to type to fly this again.
  bool estimated{false};     ///< It flew on an estimate: samples have one.
  bool fixed_wing{false};    ///< Samples have `wing`.
  bool success{false};
  std::string verdict;  ///< One sentence: why success, or why not.
  std::size_t motor_count{4};
  std::vector<Fact> facts;
  std::vector<Waypoint> waypoints;
  /// The way as it was planned, north-east-down [m]; NaN between pieces that do not join.
  std::vector<std::array<double, 3>> route;
  std::vector<Fault> faults;
  std::vector<ChangedParameter> changed_parameters;
  std::optional<link::Counters> counters;  ///< The last the firmware sent.
  std::vector<std::string> jitter_names;   ///< Of their bins.
  std::vector<std::string> rejected_names;
  GyroSpectrum gyro;               ///< In the air.
  std::vector<std::string> files;  ///< Names of the other files beside the report.

 private:
  double interval_s_;
  std::vector<Sample> samples_;
  std::vector<Lane> lanes_;
  std::vector<Event> events_;
};

/// For samples, which are kept as float.
inline constexpr float kDegPerRadF = static_cast<float>(base::kDegPerRad);

/// A value of every sample, in their order.
template <class Get>
std::vector<double> column(const FlightRecord& record, const Get& get) {
  std::vector<double> out;
  out.reserve(record.samples().size());
  for (const Sample& sample : record.samples()) out.push_back(static_cast<double>(get(sample)));
  return out;
}

}  // namespace rosflight::report
