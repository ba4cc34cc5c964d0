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

/// Calibrates the magnetometer with a person who turns the vehicle: each of the six faces down
/// once, and a full circle about the vertical with each.
///
/// 1. The correction on the FCU is set to none and confirmed, so that raw values come.
/// 2. Any face not yet done, held still for `hold`, is the next; then the vehicle is turned until
/// each of
///    ten sectors of the circle has `per_sector` samples (sectors in the plane that fits the
///    samples best). Tilted away, the face is looked for again.
/// 3. After six faces the fit (mag_fit.hpp); if it is good, its values are set and confirmed.
/// If anything fails, or on cancel(), the values from before are put back. Nothing is written to
/// non-volatile memory. Can be repeated.
class MagCalibration final : public Listener {
 public:
  static constexpr std::size_t kFaces = 6;

  struct Options {
    Time hold{std::chrono::seconds{2}};
    std::size_t per_sector{20};
    Time patience{std::chrono::minutes{2}};  ///< For one face.
    MagFit::Limits fit;
  };

  enum class State : std::uint8_t { kIdle, kResetting, kFindFace, kTurn, kStoring, kRestoring };

  struct Progress {
    State state{State::kIdle};
    std::size_t faces_done{};
    const char* face{""};  ///< "nose down"; in kTurn.
    double turned{};       ///< Share of the circle that is full, 0..1; in kTurn.
    std::size_t samples{};
  };

  explicit MagCalibration(Session& session) : MagCalibration(session, Options{}) {}
  MagCalibration(Session& session, const Options& options);
  ~MagCalibration() override;
  MagCalibration(const MagCalibration&) = delete;
  MagCalibration& operator=(const MagCalibration&) = delete;

  /// Fails at once while one runs, while armed, or if the FCU has no magnetometer parameters.
  Job<MagFit> start();
  void cancel();
  Progress progress() const;
  /// What to do next, one line, for the person.
  void on_prompt(std::function<void(const std::string&)> handler) { prompt_ = std::move(handler); }

  void on_imu(const link::Imu& imu, const Stamp& stamp) override;
  void on_mag(const link::Mag& mag, const Stamp& stamp) override;
  void on_event(const Event& event) override;

 private:
  bool collecting() const { return state_ == State::kFindFace || state_ == State::kTurn; }
  void enter(State state);
  void say(const std::string& line);
  void ask_for_face();
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
  std::optional<std::size_t> face_;  ///< That the accelerometer shows.
  Time face_since_{};
  std::size_t turning_face_{};
  std::bitset<kFaces> done_;
  std::vector<MagFit::Vector> samples_;
  std::vector<MagFit::Vector> circle_;
  double turned_{};
};

/// How full the emptiest of ten sectors is, 0..1, when samples are seen from their centroid in
/// their plane.
double circle_coverage(std::span<const MagFit::Vector> samples, std::size_t per_sector);

}  // namespace rosflight::companion
