// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/estimation/estimator.hpp"
#include "companion/session.hpp"
#include "flight/fix_age.hpp"
#include "flight/state_estimate_source.hpp"

namespace rosflight::flight {

/// Feeds an estimator with the samples that arrive over the link, and with poses from beside it. Times are companion times of the
/// samples; a message without a stamp takes the time of the IMU sample before it.
class LinkStateEstimator final : public StateEstimateSource, private companion::Listener {
 public:
  using Estimator = autonomy::estimation::Estimator;

  /// @param session  must outlive this.
  LinkStateEstimator(companion::Session& session,
                     const autonomy::estimation::EstimatorConfig& config,
                     autonomy::estimation::Airframe airframe)
      : session_{session}, estimator_{config, airframe} {
    session_.add(*this);
  }
  ~LinkStateEstimator() override { session_.remove(*this); }
  LinkStateEstimator(const LinkStateEstimator&) = delete;
  LinkStateEstimator& operator=(const LinkStateEstimator&) = delete;

  autonomy::StateEstimate estimate() const override { return estimator_.estimate(); }
  const autonomy::estimation::EstimatorHealth& health() const override {
    return estimator_.health();
  }
  const std::optional<autonomy::Geodetic>& origin() const override { return estimator_.origin(); }
  void add(const sim::PoseSample& pose) override {
    if (!enabled_) return;
    estimator_.add(
        autonomy::estimation::PoseSample{sim::to_seconds(pose.stamp), pose.p_W, pose.q_WB});
  }
  void restart() override { estimator_.restart(); }
  const Estimator& estimator() const { return estimator_; }
  void set_enabled(bool enabled) override { enabled_ = enabled; }

  /// All of it but the session, to go on from here again.
  struct Moment {
    FixAge fix_age;
    Estimator estimator;
    bool enabled;
    bool restarted;
  };
  Moment save() const { return {fix_age_, estimator_, enabled_, restarted_}; }
  void restore(const Moment& moment) {
    fix_age_ = moment.fix_age;
    estimator_ = moment.estimator;
    enabled_ = moment.enabled;
    restarted_ = moment.restarted;
  }

 private:
  static double seconds(const companion::Stamp& stamp) {
    return companion::to_seconds(stamp.sample);
  }
  static autonomy::Vector3 vector(const std::array<float, 3>& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
  }

  void on_imu(const link::Imu& m, const companion::Stamp& stamp) override {
    if (!enabled_) return;
    estimator_.set_at_rest(!session_.streams().status.value.armed);
    estimator_.add(autonomy::estimation::ImuSample{seconds(stamp), vector(m.gyro_rad_s),
                                                   vector(m.accel_m_s2)});
  }
  void on_attitude(const link::Attitude& m, const companion::Stamp& stamp) override {
    if (!enabled_ || !estimator_.wants_attitude_hint()) return;
    estimator_.set_attitude_hint(seconds(stamp),
                                 {static_cast<double>(m.q_WB[0]), static_cast<double>(m.q_WB[1]),
                                  static_cast<double>(m.q_WB[2]), static_cast<double>(m.q_WB[3])},
                                 !restarted_);
  }
  void on_event(const companion::Event& event) override {
    const auto* link = std::get_if<companion::ConnectionEvent>(&event);
    if (link != nullptr && link->change == companion::ConnectionChange::kRestarted) {
      restarted_ = true;
    }
  }
  void on_gnss(const link::Gnss& m, const companion::Stamp& stamp) override {
    constexpr int k3dFix = 3;
    if (!enabled_) return;
    autonomy::estimation::GnssSample sample;
    sample.unix_s = static_cast<double>(m.unix_s) + 1e-9 * static_cast<double>(m.unix_ns);
    sample.t_s = fix_age_.time_of_fix(seconds(stamp), sample.unix_s);
    sample.fix_3d = m.fix >= k3dFix;
    sample.position = {m.latitude_deg, m.longitude_deg, static_cast<double>(m.height_msl_m)};
    sample.v_W_m_s = vector(m.velocity_ned_m_s);
    estimator_.add(sample);
  }
  void on_baro(const link::Baro& m, const companion::Stamp& stamp) override {
    if (!enabled_) return;
    estimator_.add(
        autonomy::estimation::BaroSample{seconds(stamp), static_cast<double>(m.pressure_Pa)});
  }
  void on_mag(const link::Mag& m, const companion::Stamp& stamp) override {
    if (!enabled_) return;
    estimator_.add(autonomy::estimation::MagSample{seconds(stamp), vector(m.field_T)});
  }
  void on_range(const link::Range& m, const companion::Stamp& stamp) override {
    if (!enabled_) return;
    estimator_.add(autonomy::estimation::RangeSample{seconds(stamp), static_cast<double>(m.range_m),
                                                     static_cast<double>(m.min_m),
                                                     static_cast<double>(m.max_m)});
  }
  void on_diff_pressure(const link::DiffPressure& m, const companion::Stamp& stamp) override {
    if (!enabled_) return;
    estimator_.add(
        autonomy::estimation::PitotSample{seconds(stamp), static_cast<double>(m.pressure_Pa)});
  }

  companion::Session& session_;
  FixAge fix_age_;
  Estimator estimator_;
  bool enabled_{false};
  bool restarted_{false};  ///< The firmware began again, with a heading of its own.
};

}  // namespace rosflight::flight
