// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/estimation/estimator.hpp"
#include "companion/session.hpp"

namespace rosflight::apps {

/// The companion's own eyes, whatever filter looks through them.
class Navigator {
 public:
  Navigator() = default;
  Navigator(const Navigator&) = delete;
  Navigator& operator=(const Navigator&) = delete;
  virtual ~Navigator() = default;

  virtual autonomy::StateEstimate estimate() const = 0;
  virtual const autonomy::estimation::EstimatorHealth& health() const = 0;
  virtual const std::optional<autonomy::Geodetic>& origin() const = 0;
  virtual void restart() = 0;
  /// Off: samples pass by.
  virtual void set_listening(bool listening) = 0;
};

/// Feeds an estimator with what arrives over the link. Times are
/// companion times of the samples; what has none on the wire borrows that of the IMU sample before
/// it.
template <bool kWind>
class LinkNavigator final : public Navigator, private companion::Listener {
 public:
  using Estimator = autonomy::estimation::Estimator<kWind>;

  /// @param session  must outlive this.
  LinkNavigator(companion::Session& session, const autonomy::estimation::EstimatorConfig& config)
      : session_{session}, estimator_{config} {
    session_.add(*this);
  }
  ~LinkNavigator() override { session_.remove(*this); }
  LinkNavigator(const LinkNavigator&) = delete;
  LinkNavigator& operator=(const LinkNavigator&) = delete;

  autonomy::StateEstimate estimate() const override { return estimator_.estimate(); }
  const autonomy::estimation::EstimatorHealth& health() const override {
    return estimator_.health();
  }
  const std::optional<autonomy::Geodetic>& origin() const override { return estimator_.origin(); }
  void restart() override { estimator_.restart(); }
  /// For those who judge it.
  const Estimator& estimator() const { return estimator_; }
  void set_listening(bool listening) override { listening_ = listening; }

 private:
  static double seconds(const companion::Stamp& stamp) {
    return companion::to_seconds(stamp.sample);
  }
  static autonomy::Vector3 vector(const std::array<float, 3>& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
  }

  void on_imu(const link::Imu& m, const companion::Stamp& stamp) override {
    if (!listening_) return;
    estimator_.set_at_rest(!session_.streams().status.value.armed);
    estimator_.add(autonomy::estimation::ImuSample{seconds(stamp), vector(m.gyro_rad_s),
                                                   vector(m.accel_m_s2)});
  }
  void on_attitude(const link::Attitude& m, const companion::Stamp& stamp) override {
    if (!listening_ || estimator_.initialised()) return;
    estimator_.set_attitude_hint(seconds(stamp),
                                 {static_cast<double>(m.q_NB[0]), static_cast<double>(m.q_NB[1]),
                                  static_cast<double>(m.q_NB[2]), static_cast<double>(m.q_NB[3])});
  }
  void on_gnss(const link::Gnss& m, const companion::Stamp& stamp) override {
    constexpr int k3dFix = 3;
    if (!listening_) return;
    autonomy::estimation::GnssSample sample;
    sample.t_s = seconds(stamp);
    sample.unix_s = static_cast<double>(m.unix_s) + 1e-9 * static_cast<double>(m.unix_ns);
    sample.fix_3d = m.fix >= k3dFix;
    sample.place = {m.latitude_deg, m.longitude_deg, static_cast<double>(m.height_msl_m)};
    sample.v_N_m_s = vector(m.velocity_ned_m_s);
    estimator_.add(sample);
  }
  void on_baro(const link::Baro& m, const companion::Stamp& stamp) override {
    if (!listening_) return;
    estimator_.add(
        autonomy::estimation::BaroSample{seconds(stamp), static_cast<double>(m.pressure_Pa)});
  }
  void on_mag(const link::Mag& m, const companion::Stamp& stamp) override {
    if (!listening_) return;
    estimator_.add(autonomy::estimation::MagSample{seconds(stamp), vector(m.field_T)});
  }
  void on_range(const link::Range& m, const companion::Stamp& stamp) override {
    if (!listening_) return;
    estimator_.add(autonomy::estimation::RangeSample{seconds(stamp), static_cast<double>(m.range_m),
                                                     static_cast<double>(m.min_m),
                                                     static_cast<double>(m.max_m)});
  }
  void on_diff_pressure(const link::DiffPressure& m, const companion::Stamp& stamp) override {
    if (!listening_) return;
    estimator_.add(
        autonomy::estimation::PitotSample{seconds(stamp), static_cast<double>(m.pressure_Pa)});
  }

  companion::Session& session_;
  Estimator estimator_;
  bool listening_{false};
};

}  // namespace rosflight::apps
