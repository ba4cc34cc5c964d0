// SPDX-License-Identifier: BSD-3-Clause
// Every derivative of the filter against central differences of the function it belongs to, at
// random states.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "autonomy/estimation/error_state_ekf.hpp"

namespace rosflight::autonomy::estimation {
namespace {

constexpr double kGravity = 9.80665;
constexpr int kStates = 200;

class RandomStates {
 public:
  explicit RandomStates(unsigned seed) : generator_{seed} {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(generator_);
  }
  Vector3 vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  /// Any attitude, inverted and nose-up included.
  NominalState state() {
    NominalState x;
    x.q_WB =
        Quaternion(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
    x.v_W = vector(20.0);
    x.p_W = vector(300.0);
    x.gyro_bias_B = vector(0.2);
    x.accel_bias_B = vector(0.6);
    x.baro_bias_m = uniform(-50.0, 50.0);
    x.wind_W = vector(8.0).head<2>();
    x.gnss_bias_W = vector(5.0);
    x.mag_bias_B = vector(2e-6);
    x.air_scale_B = vector(0.8).head<2>();
    x.gust_down_m_s = uniform(-2.0, 2.0);
    x.lift_offset_rad = uniform(-0.05, 0.05);
    return x;
  }
  ImuIncrement increment() {
    ImuIncrement u;
    u.dt_s = uniform(1e-4, 0.05);
    u.dtheta_B = u.dt_s * vector(4.0);
    u.dv_B = u.dt_s * (vector(10.0) - Vector3(0.0, 0.0, kGravity));
    return u;
  }

 private:
  std::mt19937 generator_;
};

using Filter = ErrorStateEkf;

/// Largest entry of a difference, by the largest entry of what it is compared with.
template <class A, class B>
double relative_difference(const A& a, const B& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1.0, b.cwiseAbs().maxCoeff());
}

constexpr double kStep = 1e-5;
// Central differences are good to kStep^2 times a third derivative (about the state's size) and to
// rounding, 1e-16 of 300 m over kStep.
constexpr double kTolerance = 1e-8;

TEST(Jacobian, OfTheTransition) {
  RandomStates random(1);
  for (int n = 0; n < kStates; ++n) {
    const NominalState x = random.state();
    const ImuIncrement u = random.increment();
    Filter::Covariance numeric;
    for (int k = 0; k < Filter::kSize; ++k) {
      NominalState plus = Filter::added(x, kStep * Filter::Error::Unit(k));
      NominalState minus = Filter::added(x, -kStep * Filter::Error::Unit(k));
      NominalState middle = x;
      for (NominalState* state : {&plus, &minus, &middle}) Filter::propagate(*state, u, kGravity);
      numeric.col(k) =
          (Filter::difference(plus, middle) - Filter::difference(minus, middle)) / (2.0 * kStep);
    }
    ProcessNoise noise;
    noise.gnss_slow_time_s = noise.gust_down_time_s = 1e9;  // propagate() leaves these as they are
    const Filter::Covariance F = Filter::transition(x, u, noise);
    ASSERT_LT(relative_difference(F, numeric), kTolerance) << n;
    Eigen::Matrix<double, Filter::kSize, 5> errors;
    for (int k = 0; k < errors.size(); ++k) errors.data()[k] = random.uniform(-1.0, 1.0);
    const Eigen::Matrix<double, Filter::kSize, 5> product = F * errors;
    Filter::carry(x, u, noise, errors);
    ASSERT_LT(relative_difference(errors, product), 1e-14) << n;
  }
}

/// Checks the H of a residual: y - h falls by H dx when the state moves by dx.
template <class Function>
void check(const Function& residual_of, unsigned seed,
           const std::function<bool(const NominalState&)>& usable = nullptr) {
  RandomStates random(seed);
  for (int n = 0; n < kStates;) {
    const NominalState x = random.state();
    if (usable && !usable(x)) continue;
    ++n;
    const auto residual = residual_of(x);
    auto numeric = residual.H;
    for (int k = 0; k < Filter::kSize; ++k) {
      const auto plus = residual_of(Filter::added(x, kStep * Filter::Error::Unit(k)));
      const auto minus = residual_of(Filter::added(x, -kStep * Filter::Error::Unit(k)));
      numeric.col(k) = (minus.nu - plus.nu) / (2.0 * kStep);
    }
    ASSERT_LT(relative_difference(residual.H, numeric), 20.0 * kTolerance) << n;
  }
}

const Vector3 kLever(-0.12, 0.05, -0.08);

TEST(Jacobian, OfGnssPosition) {
  check([](const NominalState& x) { return Filter::gnss_position(x, {3, -4, 5}, kLever); }, 2);
}

TEST(Jacobian, OfGnssVelocity) {
  check(
      [](const NominalState& x) {
        return Filter::gnss_velocity(x, {3, -4, 5}, kLever, {1, 2, -3});
      },
      3);
}

TEST(Jacobian, OfBaroHeight) {
  check([](const NominalState& x) { return Filter::baro_height(x, 12.0); }, 4);
}

TEST(Jacobian, OfMagneticHeading) {
  // Where the measurement equals its prediction from the state; elsewhere H leaves the noise out on purpose.
  const Vector3 field_W(2.1e-5, 0.4e-5, 4.6e-5);
  const double declination = std::atan2(field_W.y(), field_W.x());
  RandomStates random(5);
  for (int n = 0; n < kStates; ++n) {
    const NominalState x = random.state();
    const Vector3 field_B = x.q_WB.conjugate() * field_W + x.mag_bias_B;
    const auto of = [&](double step, int k) {
      const NominalState moved = Filter::added(x, step * Filter::Error::Unit(k));
      return Filter::magnetic_heading(moved, field_B, declination).nu(0);
    };
    const auto H = Filter::magnetic_heading(x, field_B, declination).H;
    for (int k = 0; k < Filter::kSize; ++k) {
      ASSERT_NEAR(H(k), (of(-kStep, k) - of(kStep, k)) / (2.0 * kStep), 20.0 * kTolerance) << n;
    }
  }
}

TEST(Jacobian, OfRange) {
  check([](const NominalState& x) { return Filter::range(x, 2.0, -1.0, kLever); }, 6,
        [](const NominalState& x) { return std::abs((x.q_WB * Vector3::UnitZ()).z()) > 0.3; });
}

TEST(Jacobian, OfPitotAndSideslip) {
  check([](const NominalState& x) { return Filter::pitot(x, 100.0, 1.1); }, 7);
  check([](const NominalState& x) { return Filter::sideslip(x, 0.3); }, 8);
}

TEST(Jacobian, OfAirForce) {
  const auto flies = [](const NominalState& x) { return x.v_W.norm() > 1.0; };
  for (int axis = 0; axis < 2; ++axis) {
    check([axis](const NominalState& x) { return Filter::air_force(x, axis, 0.7, {0.5, 0.02}); },
          12U + static_cast<unsigned>(axis), flies);
  }
}

TEST(Jacobian, OfLift) {
  const LiftModel model{0.11, 0.5, 5.6};
  const auto flies = [](const NominalState& x) {
    return std::abs(Filter::air_velocity_B(x).x()) > 5.0;
  };
  check([&](const NominalState& x) { return Filter::lift(x, -9.0, 1.1, model); }, 15, flies);
}

TEST(Jacobian, OfVelocity) {
  check([](const NominalState& x) { return Filter::velocity(x, Vector3::Zero()); }, 9);
}

/// predict() works by blocks; one prediction must be F P F' + Q with the F tested above.
TEST(Jacobian, PredictionByBlocksIsTheWholeProduct) {
  RandomStates random(10);
  for (int n = 0; n < kStates; ++n) {
    Filter filter;
    filter.state() = random.state();
    Filter::Covariance half;
    for (int k = 0; k < half.size(); ++k) half.data()[k] = random.uniform(-1.0, 1.0);
    filter.covariance() = half * half.transpose();
    const ImuIncrement u = random.increment();
    const ProcessNoise noise{};
    const auto F = Filter::transition(filter.state(), u, noise);
    Filter::Covariance expected = F * filter.covariance() * F.transpose();
    // Q = G W G' with the noise of the increments: dtheta, dv and the walks.
    Filter::Covariance Q = Filter::Covariance::Zero();
    const double dt = u.dt_s;
    const auto add = [&](int first, int size, double density) {
      for (int k = first; k < first + size; ++k) Q(k, k) += density * density * dt;
    };
    add(Filter::kTheta, 3, noise.gyro_rad_s_rtHz);
    add(Filter::kGyroBias, 3, noise.gyro_bias_rad_s_rts);
    add(Filter::kAccelBias, 3, noise.accel_bias_m_s2_rts);
    add(Filter::kBaroBias, 1, noise.baro_bias_m_rts);
    add(Filter::kWind, 2, noise.wind_m_s_rts);
    add(Filter::kMagBias, 3, noise.mag_bias_T_rts / Filter::kMicrotesla);
    add(Filter::kAirScale, 2, noise.air_scale_rts);
    // Stationary: what decays is renewed, so that the variance stays that of the process.
    const double renewed = -std::expm1(-2.0 * dt / noise.gnss_slow_time_s) / dt;
    add(Filter::kGnssBias, 2, noise.gnss_slow_horizontal_m * std::sqrt(renewed));
    add(Filter::kGnssBias + 2, 1, noise.gnss_slow_altitude_m * std::sqrt(renewed));
    const double of_gust = -std::expm1(-2.0 * dt / noise.gust_down_time_s) / dt;
    add(Filter::kGust, 1, noise.gust_down_m_s * std::sqrt(of_gust));
    add(Filter::kLiftOffset, 1, noise.lift_offset_rad_rts);
    Eigen::Matrix<double, Filter::kSize, 3> G = Eigen::Matrix<double, Filter::kSize, 3>::Zero();
    G.template middleRows<3>(Filter::kVelocity).setIdentity();
    G.template middleRows<3>(Filter::kPosition) = 0.5 * dt * Matrix3::Identity();
    Q += noise.accel_m_s2_rtHz * noise.accel_m_s2_rtHz * dt * G * G.transpose();
    expected += Q;
    filter.predict(u, noise, kGravity);
    ASSERT_LT(relative_difference(filter.covariance(), expected), 1e-13) << n;
  }
}

TEST(Filter, CoupledErrorsHaveTheCovarianceOfTheirSum) {
  // a + b was measured with a sigma of 0.3: the sum has that variance, b and all others keep theirs.
  RandomStates random(20);
  Filter filter;
  Filter::Covariance half;
  for (int k = 0; k < half.size(); ++k) half.data()[k] = random.uniform(-1.0, 1.0);
  filter.covariance() = half * half.transpose();
  const Filter::Covariance before = filter.covariance();
  filter.couple(Filter::kPosition, Filter::kGnssBias, 2, 0.3);
  const Filter::Covariance& P = filter.covariance();
  for (int k = 0; k < 2; ++k) {
    const int a = Filter::kPosition + k, b = Filter::kGnssBias + k;
    EXPECT_NEAR(P(a, a) + P(b, b) + 2.0 * P(a, b), 0.09, 1e-12);
    EXPECT_EQ(P(b, b), before(b, b));
  }
  EXPECT_EQ(P(Filter::kTheta, Filter::kGyroBias), before(Filter::kTheta, Filter::kGyroBias));
  EXPECT_GT(P.ldlt().vectorD().minCoeff(), -1e-9);
  EXPECT_LT((P - P.transpose()).norm(), 1e-12);
}

TEST(Filter, AHeadingCorrectsHeadingAndIronAndKnowsWhatItLeftAlone) {
  RandomStates random(21);
  for (int n = 0; n < kStates; ++n) {
    Filter filter;
    filter.state() = random.state();
    Filter::Covariance half;
    for (int k = 0; k < half.size(); ++k) half.data()[k] = random.uniform(-0.1, 0.1);
    filter.covariance() = half * half.transpose();
    auto r = Filter::magnetic_heading(filter.state(), {2e-5, 3e-6, 4e-5}, 0.2);
    r.R(0) = 1e-3;
    const NominalState before = filter.state();
    const Filter::Covariance P = filter.covariance();
    const Vector3 down_B = before.q_WB.conjugate() * Vector3::UnitZ();
    // The optimal gain of what is corrected, none of the rest, in the form of P. D. Joseph (1964),
    // which holds for every gain.
    Filter::Covariance chosen = Filter::Covariance::Zero();
    for (const int first : {Filter::kTheta, Filter::kGyroBias}) {
      chosen.block<3, 3>(first, first) = down_B * down_B.transpose();
    }
    chosen.block<3, 3>(Filter::kMagBias, Filter::kMagBias).setIdentity();
    const double S = (r.H * P * r.H.transpose())(0) + r.R(0);
    const Filter::Error K = chosen * P * r.H.transpose() / S;
    const Filter::Covariance rest = Filter::Covariance::Identity() - K * r.H;
    const Filter::Covariance expected = rest * P * rest.transpose() + r.R(0) * K * K.transpose();
    Filter calm = filter;
    auto tiny = r;
    tiny.nu(0) = 1e-9;  // does not turn the covariance
    ASSERT_TRUE(calm.correct_heading(tiny, 5.0).accepted);
    ASSERT_LT((calm.covariance() - expected).norm(), 1e-12 * P.norm()) << n;

    r.nu(0) = 0.3;
    ASSERT_TRUE(filter.correct_heading(r, 1e6).accepted);
    const NominalState& after = filter.state();
    EXPECT_LT((after.q_WB.conjugate() * Vector3::UnitZ() - down_B).norm(), 1e-12) << "tilt";
    EXPECT_EQ(after.v_W, before.v_W);
    EXPECT_EQ(after.p_W, before.p_W);
    EXPECT_EQ(after.accel_bias_B, before.accel_bias_B);
    EXPECT_LT((after.gyro_bias_B - before.gyro_bias_B).cross(down_B).norm(), 1e-12);
    Filter other = filter;
    r.nu(0) = 100.0;
    EXPECT_FALSE(other.correct_heading(r, 5.0).accepted);
    EXPECT_EQ(other.covariance(), filter.covariance());
  }
}

TEST(Rotation, ExponentialAndLogarithmUndoEachOther) {
  RandomStates random(11);
  for (int n = 0; n < kStates; ++n) {
    const double size = std::pow(10.0, random.uniform(-12.0, 0.25));
    const Vector3 phi = random.vector(size);
    EXPECT_LT((log_rotation(exp_rotation(phi)) - phi).norm(), 1e-14 + 1e-15 * size);
    EXPECT_NEAR(exp_rotation(phi).norm(), 1.0, 1e-15);
    const Eigen::AngleAxisd known(phi.norm(), phi.normalized());
    EXPECT_LT(exp_rotation(phi).angularDistance(Quaternion(known)), 1e-7);
  }
}

TEST(Gate, HasTheTailOfAScalar) {
  // Chi-square quantiles of three degrees of freedom at the two-sided normal tails of 3 and 5 sigma
  // (the tail is erfc(sqrt(x/2)) + sqrt(2 x/pi) exp(-x/2)).
  EXPECT_DOUBLE_EQ(Filter::gate(1, 3.0), 9.0);
  EXPECT_NEAR(Filter::gate(3, 3.0), 14.156, 0.04 * 14.156);
  EXPECT_NEAR(Filter::gate(3, 5.0), 31.812, 0.04 * 31.812);
  // For two degrees of freedom the tail is exp(-x/2).
  EXPECT_NEAR(Filter::gate(2, 3.0), -2.0 * std::log(std::erfc(3.0 / std::sqrt(2.0))), 0.3);
  EXPECT_NEAR(Filter::gate(2, 5.0), -2.0 * std::log(std::erfc(5.0 / std::sqrt(2.0))), 0.6);
}

}  // namespace
}  // namespace rosflight::autonomy::estimation
