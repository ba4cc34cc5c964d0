// SPDX-License-Identifier: BSD-3-Clause
#include "companion/mag_calibration.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/constants.hpp"

namespace rosflight::companion {

namespace {

constexpr double kGravity_m_s2 = base::kStandardGravity_m_s2;
constexpr double kFaceTolerance_m_s2 = 1.0;  // 26 deg of tilt
constexpr double kStill_rad_s = 0.3;
constexpr double kAccelWeight = 0.05;  // 50 ms at 400 Hz
constexpr Time kTiltedAway = std::chrono::seconds{1};
constexpr std::size_t kCircleSectors = 10;
// Radius of the circle over the strength of the samples: noise is below 1 %, a turn in a field inclined by
// 85 deg 9 %.
constexpr double kMinRadius = 0.02;
constexpr std::size_t kCheckEvery = 10;
constexpr std::size_t kMaxSamples = 50000;

/// Specific force +g or -g on x, y, z: at rest the accelerometer shows what holds it up.
constexpr std::array<const char*, MagCalibration::kFaces> kFaceNames = {
    "nose up", "nose down", "left side down", "right side down", "upside down", "level"};

constexpr std::array<const char*, 3> kBiasNames = {"MAG_X_BIAS", "MAG_Y_BIAS", "MAG_Z_BIAS"};
constexpr std::array<std::array<const char*, 3>, 3> kMatrixNames = {
    {{"MAG_CAL_A00", "MAG_CAL_A01", "MAG_CAL_A02"},
     {"MAG_CAL_A10", "MAG_CAL_A11", "MAG_CAL_A12"},
     {"MAG_CAL_A20", "MAG_CAL_A21", "MAG_CAL_A22"}}};

ParameterSet correction(const MagFit::Vector& bias, const std::array<MagFit::Vector, 3>& matrix) {
  ParameterSet set;
  for (std::size_t i = 0; i < 3; ++i) {
    set.push_back({kBiasNames[i], ParameterValue::of(static_cast<float>(bias[i]))});
    for (std::size_t j = 0; j < 3; ++j) {
      set.push_back({kMatrixNames[i][j], ParameterValue::of(static_cast<float>(matrix[i][j]))});
    }
  }
  return set;
}

ParameterSet no_correction() {
  return correction({},
                    {MagFit::Vector{1, 0, 0}, MagFit::Vector{0, 1, 0}, MagFit::Vector{0, 0, 1}});
}

std::optional<std::size_t> face_of(const std::array<double, 3>& accel_m_s2) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(accel_m_s2[axis] - kGravity_m_s2) < kFaceTolerance_m_s2) {
      return 2 * axis;
    }
    if (std::abs(accel_m_s2[axis] + kGravity_m_s2) < kFaceTolerance_m_s2) {
      return 2 * axis + 1;
    }
  }
  return std::nullopt;
}

std::string summary(const MagFit& fit) {
  std::array<char, 160> text{};
  std::snprintf(
      text.data(), text.size(),
      "field strength %.4g, error %.1f %% (%.1f %% before), %.0f %% of all directions seen",
      fit.field, 100.0 * fit.residual, 100.0 * fit.raw_residual, 100.0 * fit.coverage);
  return text.data();
}

}  // namespace

double circle_coverage(std::span<const MagFit::Vector> samples, std::size_t per_sector) {
  if (samples.size() < kCircleSectors * per_sector) {
    return 0.0;
  }
  using Eigen::Vector3d;
  const auto point = [](const MagFit::Vector& s) { return Vector3d(s[0], s[1], s[2]); };
  Vector3d centre = Vector3d::Zero();
  for (const MagFit::Vector& s : samples) {
    centre += point(s);
  }
  centre /= static_cast<double>(samples.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double strength_squared = 0.0;
  for (const MagFit::Vector& s : samples) {
    const Vector3d d = point(s) - centre;
    scatter += d * d.transpose();
    strength_squared += point(s).squaredNorm();
  }
  if (scatter.trace() < kMinRadius * kMinRadius * strength_squared) {
    return 0.0;  // noise lies in all directions too
  }
  // Eigenvalues ascend: the normal of the plane comes first.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  const Vector3d x = axes.eigenvectors().col(2);
  const Vector3d y = axes.eigenvectors().col(1);
  std::array<std::size_t, kCircleSectors> filled{};
  for (const MagFit::Vector& s : samples) {
    const Vector3d d = point(s) - centre;
    const double turn = std::atan2(y.dot(d), x.dot(d)) / (2.0 * base::kPi) + 0.5;
    const auto sector =
        static_cast<std::size_t>(std::max(turn, 0.0) * static_cast<double>(kCircleSectors));
    ++filled[std::min(sector, kCircleSectors - 1)];
  }
  const std::size_t emptiest = *std::min_element(filled.begin(), filled.end());
  return std::min(1.0, static_cast<double>(emptiest) / static_cast<double>(per_sector));
}

MagCalibration::MagCalibration(Session& session, const Options& options)
    : session_(session), options_(options) {
  session_.add(*this);
}

MagCalibration::~MagCalibration() {
  session_.remove(*this);
  if (job_) {
    end(JobState::kFailed, "abandoned");
  }
}

Job<MagFit> MagCalibration::start() {
  auto record = std::make_shared<JobRecord<MagFit>>();
  record->started = session_.now();
  const auto refuse = [&](const std::string& reason) {
    record->state = JobState::kFailed;
    record->finished = session_.now();
    record->text = "magnetometer calibration: " + reason;
    return Job<MagFit>(record);
  };
  if (job_) {
    return refuse("already in progress");
  }
  if (session_.streams().status.value.armed) {
    return refuse("refused: the vehicle is armed");
  }
  ParameterSet before = no_correction();
  for (NamedValue& entry : before) {
    const auto value = session_.parameters().get(entry.name);
    if (!value) {
      return refuse(entry.name + " is not known: no connection, or another firmware");
    }
    entry.value = *value;
  }
  before_ = std::move(before);
  job_ = record;
  failure_.clear();
  samples_.clear();
  done_.reset();
  accel_started_ = false;
  set_all(no_correction(), State::kResetting, &MagCalibration::reset_done);
  return Job<MagFit>(record);
}

void MagCalibration::cancel() {
  if (collecting() || state_ == State::kResetting) {
    fail("cancelled");
  }
}

MagCalibration::Progress MagCalibration::progress() const {
  const bool turning = state_ == State::kTurn;
  return {state_, done_.count(), turning ? kFaceNames[turning_face_] : "", turning ? turned_ : 0.0,
          samples_.size()};
}

void MagCalibration::set_all(const ParameterSet& set, State state,
                             void (MagCalibration::*then)(const Job<LoadReport>&)) {
  enter(state);
  Job<LoadReport> load = session_.parameters().load(set);
  const std::weak_ptr<int> alive = alive_;
  load.when_finished([this, alive, load, state, then] {
    if (!alive.expired() && state_ == state) {
      (this->*then)(load);
    }
  });
}

void MagCalibration::reset_done(const Job<LoadReport>& job) {
  if (!job.done()) {
    fail("old correction cannot be taken away: " + job.text());
    return;
  }
  prompt_for_face();
}

void MagCalibration::prompt_for_face() {
  enter(State::kFindFace);
  face_since_ = now_;
  prompt(std::to_string(done_.count()) +
         " of 6 faces done: put the vehicle on another face and hold it still");
}

void MagCalibration::on_imu(const link::Imu& imu, const Stamp& stamp) {
  now_ = stamp.arrival;
  if (!collecting()) {
    return;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto a = static_cast<double>(imu.accel_m_s2[i]);
    accel_m_s2_[i] = accel_started_ ? accel_m_s2_[i] + kAccelWeight * (a - accel_m_s2_[i]) : a;
  }
  accel_started_ = true;
  const auto face = face_of(accel_m_s2_);
  if (face != face_) {
    face_ = face;
    face_since_ = now_;
  }
  if (now_ - state_since_ > options_.face_timeout) {
    fail("nothing new for too long");
  } else if (state_ == State::kFindFace) {
    find_face(imu);
  } else {
    watch_turn();
  }
}

void MagCalibration::find_face(const link::Imu& imu) {
  double rate_squared = 0.0;
  for (const float w : imu.gyro_rad_s) {
    rate_squared += static_cast<double>(w) * static_cast<double>(w);
  }
  if (!face_ || done_[*face_] || rate_squared > kStill_rad_s * kStill_rad_s) {
    face_since_ = now_;
    return;
  }
  if (now_ - face_since_ >= options_.hold) {
    turning_face_ = *face_;
    circle_.clear();
    turned_ = 0.0;
    enter(State::kTurn);
    prompt(std::string(kFaceNames[turning_face_]) + ": turn a full circle about the vertical");
  }
}

void MagCalibration::watch_turn() {
  if (face_ != turning_face_ && now_ - face_since_ > kTiltedAway) {
    prompt_for_face();
  }
}

void MagCalibration::on_mag(const link::Mag& mag, const Stamp& /*stamp*/) {
  if (!collecting() || samples_.size() >= kMaxSamples) {
    return;
  }
  MagFit::Vector sample{};
  for (std::size_t i = 0; i < 3; ++i) {
    sample[i] = static_cast<double>(mag.field_T[i]);
    if (!std::isfinite(sample[i])) {
      return;
    }
  }
  samples_.push_back(sample);
  if (state_ != State::kTurn || face_ != turning_face_) {
    return;
  }
  circle_.push_back(sample);
  if (circle_.size() % kCheckEvery == 0) {
    turned_ = circle_coverage(circle_, options_.per_sector);
    if (turned_ >= 1.0) {
      face_done();
    }
  }
}

void MagCalibration::face_done() {
  done_.set(turning_face_);
  if (done_.all()) {
    finish_fit();
  } else {
    prompt_for_face();
  }
}

void MagCalibration::finish_fit() {
  job_->result = fit_magnetometer(samples_, options_.fit);
  const MagFit& fit = job_->result;
  if (fit.status != MagFit::Status::kOk) {
    fail(std::string(mag_fit_status_text(fit.status)) + " (" + summary(fit) + ")");
    return;
  }
  set_all(correction(fit.bias, fit.matrix), State::kStoring, &MagCalibration::store_done);
}

void MagCalibration::store_done(const Job<LoadReport>& job) {
  if (!job.done()) {
    fail("new correction cannot be set: " + job.text());
    return;
  }
  end(JobState::kDone, summary(job_->result));
}

void MagCalibration::on_event(const Event& event) {
  const auto* connection = std::get_if<ConnectionEvent>(&event);
  const bool matters = collecting() || state_ == State::kStoring;
  if (connection == nullptr || !matters) {
    return;
  }
  if (connection->change == ConnectionChange::kLost) {
    fail("connection lost");
  } else if (connection->change == ConnectionChange::kRestarted) {
    // Its stored correction is in force again.
    end(JobState::kFailed, "the flight control unit restarted");
  }
}

void MagCalibration::fail(const std::string& reason) {
  failure_ = reason;
  set_all(before_, State::kRestoring, &MagCalibration::restore_done);
}

void MagCalibration::restore_done(const Job<LoadReport>& job) {
  end(JobState::kFailed,
      failure_ + (job.done() ? "; old correction put back"
                             : "; old correction could not be put back: " + job.text()));
}

void MagCalibration::enter(State state) {
  state_ = state;
  state_since_ = session_.now();
}

void MagCalibration::prompt(const std::string& line) {
  job_->text = "magnetometer calibration: " + line;
  if (prompt_) {
    prompt_(line);
  }
}

void MagCalibration::end(JobState state, const std::string& text) {
  const auto record = std::exchange(job_, nullptr);
  state_ = State::kIdle;
  ends_.finish(record, state, "magnetometer calibration: " + text, session_.now());
  ends_.flush();
}

}  // namespace rosflight::companion
