// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <bitset>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "companion/job.hpp"
#include "companion/listener.hpp"
#include "companion/mag_fit.hpp"
#include "companion/parameter.hpp"
#include "companion/session.hpp"

namespace rosflight::companion {

/// Calibrates the magnetometer while a person turns the vehicle: each of the six faces down once,
/// and a full circle about the vertical with each.
///
/// 1. The correction on the FCU is cleared and confirmed, so that raw values are received.
/// 2. A face that is not done yet and is held still for `hold` is the next. The vehicle is then
///    turned until each of ten sectors of the circle has `per_sector` samples; the sectors lie in
///    the plane that fits the samples best. If the vehicle is tilted, the face is detected again.
/// 3. After six faces the samples are fitted (mag_fit.hpp); a good fit is set and confirmed.
///
/// After a failure or cancel() the previous values are restored. Nothing is written to non-volatile
/// memory. Can be repeated.
class MagCalibration final : public Listener {
 public:
  static constexpr std::size_t kFaces = 6;

  struct Options {
    Time hold{std::chrono::seconds{2}};
    std::size_t per_sector{20};
    Time face_timeout{std::chrono::minutes{2}};
    MagFit::Limits fit;
  };

  enum class State : std::uint8_t { kIdle, kResetting, kFindFace, kTurn, kStoring, kRestoring };

  struct Progress {
    State state{State::kIdle};
    std::size_t faces_done{};
    const char* face{""};  ///< "nose down"; in kTurn.
    double turned{};       ///< Fraction of the circle that is complete, 0..1; in kTurn.
    std::size_t samples{};
  };

  /// @param session  must outlive this.
  explicit MagCalibration(Session& session) : MagCalibration(session, Options{}) {}
  MagCalibration(Session& session, const Options& options);
  ~MagCalibration() override;
  MagCalibration(const MagCalibration&) = delete;
  MagCalibration& operator=(const MagCalibration&) = delete;

  /// Starts. The job fails at once if one is running, while armed, or if the FCU has no magnetometer
  /// parameters.
  Job<MagFit> start();
  /// Ends the job and restores the previous values.
  void cancel();
  Progress progress() const;
  /// Sets the function that receives the next instruction for the person, one line.
  void on_prompt(std::function<void(const std::string&)> handler) { prompt_ = std::move(handler); }

  void on_imu(const link::Imu& imu, const Stamp& stamp) override;
  void on_mag(const link::Mag& mag, const Stamp& stamp) override;
  void on_event(const Event& event) override;

 private:
  bool collecting() const { return state_ == State::kFindFace || state_ == State::kTurn; }
  void enter(State state);
  void prompt(const std::string& line);
  void prompt_for_face();
  void find_face(const link::Imu& imu);
  void watch_turn();
  void face_done();
  void finish_fit();
  void set_all(const ParameterSet& set, State state,
               void (MagCalibration::*then)(const Job<LoadReport>&));
  void reset_done(const Job<LoadReport>& job);
  void store_done(const Job<LoadReport>& job);
  void restore_done(const Job<LoadReport>& job);
  void fail(const std::string& reason);
  void end(JobState state, const std::string& text);

  Session& session_;
  Options options_;
  std::function<void(const std::string&)> prompt_;
  std::shared_ptr<JobRecord<MagFit>> job_;
  JobEnds ends_;
  std::shared_ptr<int> alive_{std::make_shared<int>(0)};
  ParameterSet before_;
  std::string failure_;
  State state_{State::kIdle};
  Time now_{};
  Time state_since_{};
  std::array<double, 3> accel_m_s2_{};  ///< Low-passed.
  bool accel_started_{false};
  std::optional<std::size_t> face_;  ///< The face that is down, by the accelerometer.
  Time face_since_{};
  std::size_t turning_face_{};
  std::bitset<kFaces> done_;
  std::vector<MagFit::Vector> samples_;
  std::vector<MagFit::Vector> circle_;
  double turned_{};
};

/// Fill of the emptiest of ten sectors, 0..1, with samples seen from their centroid in their plane;
/// 0 for samples that hardly differ, such as the noise of a vehicle at rest.
double circle_coverage(std::span<const MagFit::Vector> samples, std::size_t per_sector);

}  // namespace rosflight::companion
