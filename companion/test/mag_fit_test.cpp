// SPDX-License-Identifier: BSD-3-Clause
#include "companion/mag_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "companion/test/fake_fcu.hpp"

namespace rosflight::companion::test {
namespace {

using Vector = MagFit::Vector;

/// A sensor whose true correction is known: m = A^-1 h + b, with A symmetric and det A = 1.
/// A = R diag(1.2, 1/1.2, 1) R', R a turn of 30 deg about z; its inverse has 1/1.2 and 1.2
/// exchanged.
struct Sensor {
  double field{50e-6};
  Vector bias{12e-6, -7e-6, 21e-6};

  static double part(double a, double b, std::size_t i, std::size_t j) {
    const double c = std::cos(std::numbers::pi / 6);
    const double s = std::sin(std::numbers::pi / 6);
    const double m[3][3] = {{a * c * c + b * s * s, (a - b) * c * s, 0},
                            {(a - b) * c * s, a * s * s + b * c * c, 0},
                            {0, 0, 1}};
    return m[i][j];
  }
  static double a(std::size_t i, std::size_t j) { return part(1.2, 1 / 1.2, i, j); }
  static double a_inverse(std::size_t i, std::size_t j) { return part(1 / 1.2, 1.2, i, j); }

  Vector measure(const Vector& direction) const {
    Vector m = bias;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        m[i] += a_inverse(i, j) * field * direction[j];
      }
    }
    return m;
  }
};

/// Even cover of the sphere by the golden spiral.
std::vector<Vector> whole_sphere(std::size_t n) {
  std::vector<Vector> directions;
  for (std::size_t k = 0; k < n; ++k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / static_cast<double>(n);
    const double phi = static_cast<double>(k) * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    directions.push_back({r * std::cos(phi), r * std::sin(phi), z});
  }
  return directions;
}

/// Full turns with each body axis pointing up and down, in a field of the given inclination.
std::vector<Vector> six_rings(double inclination_rad, std::size_t per_ring) {
  std::vector<Vector> directions;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      for (std::size_t k = 0; k < per_ring; ++k) {
        const double phi =
            2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(per_ring);
        Vector d{};
        d[axis] = sign * std::sin(inclination_rad);
        d[(axis + 1) % 3] = std::cos(inclination_rad) * std::cos(phi);
        d[(axis + 2) % 3] = std::cos(inclination_rad) * std::sin(phi);
        directions.push_back(d);
      }
    }
  }
  return directions;
}

std::vector<Vector> measured(const std::vector<Vector>& directions, double noise = 0.0) {
  const Sensor sensor;
  Random random(11);
  std::vector<Vector> samples;
  for (const Vector& d : directions) {
    Vector m = sensor.measure(d);
    for (double& x : m) {
      x += noise * (random.uniform() - 0.5) *
           std::sqrt(12.0);  // even noise of that standard deviation
    }
    samples.push_back(m);
  }
  return samples;
}

void expect_found(const MagFit& fit, double tolerance) {
  const Sensor sensor;
  ASSERT_EQ(fit.status, MagFit::Status::kOk) << mag_fit_status_text(fit.status);
  EXPECT_NEAR(fit.field, sensor.field, tolerance * sensor.field);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(fit.bias[i], sensor.bias[i], tolerance * sensor.field);
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(fit.matrix[i][j], Sensor::a(i, j), tolerance);
    }
  }
}

TEST(MagFit, FindsTheExactCorrectionWithoutNoise) {
  const MagFit fit = fit_magnetometer(measured(whole_sphere(500)));
  expect_found(fit, 1e-8);
  EXPECT_LT(fit.residual, 1e-8);
  EXPECT_GT(fit.raw_residual, 0.1);
  EXPECT_GT(fit.coverage, 0.95);
  EXPECT_GT(fit.determination, 0.03);
}

TEST(MagFit, SixRingsAreEnough) {
  for (const double inclination_deg : {0.0, 30.0, 50.0, 65.0, 75.0}) {
    const auto samples = measured(six_rings(inclination_deg * std::numbers::pi / 180, 600));
    const MagFit fit = fit_magnetometer(samples);
    expect_found(fit, 1e-6);
  }
}

// 1 % noise per axis, 3600 samples: errors of the order 1 % / sqrt(3600) times the dilution of the
// rings.
TEST(MagFit, NoiseAveragesOut) {
  const auto samples = measured(six_rings(65 * std::numbers::pi / 180, 600), 0.01 * 50e-6);
  const MagFit fit = fit_magnetometer(samples);
  expect_found(fit, 0.005);
  EXPECT_NEAR(fit.residual, 0.01, 0.002);
  const Vector corrected = fit.corrected(Sensor().measure({0, 0, 1}));
  EXPECT_NEAR(corrected[2], 50e-6, 0.3e-6);
}

TEST(MagFit, RefusesWhatDoesNotDetermineTheAnswer) {
  EXPECT_EQ(fit_magnetometer({}).status, MagFit::Status::kTooFewSamples);
  EXPECT_EQ(fit_magnetometer(measured(whole_sphere(99))).status, MagFit::Status::kTooFewSamples);
  const std::vector<Vector> still(500, Vector{1e-5, 2e-5, 3e-5});
  EXPECT_EQ(fit_magnetometer(still).status, MagFit::Status::kUndetermined);
  // Turned about one axis only.
  auto ring = six_rings(1.0, 600);
  ring.resize(600);
  EXPECT_EQ(fit_magnetometer(measured(ring, 1e-7)).status, MagFit::Status::kUndetermined);
  // Only the northern half of the sphere.
  auto cap = whole_sphere(4000);
  std::erase_if(cap, [](const Vector& d) { return d[2] < 0.0; });
  EXPECT_EQ(fit_magnetometer(measured(cap, 0.005 * 50e-6)).status, MagFit::Status::kUndetermined);
}

TEST(MagFit, RefusesADisturbedField) {
  auto samples = measured(whole_sphere(1000));
  for (std::size_t k = 0; k < samples.size(); k += 5) {
    for (double& x : samples[k]) {
      x *= 1.3;  // a car drove by
    }
  }
  EXPECT_EQ(fit_magnetometer(samples).status, MagFit::Status::kPoorFit);
}

TEST(MagFit, RefusesNumbersThatAreNone) {
  auto samples = measured(whole_sphere(200));
  samples[17][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fit_magnetometer(samples).status, MagFit::Status::kNotFinite);
}

// Any unit: a sensor that counts in thousands gives the same A.
TEST(MagFit, DoesNotDependOnTheUnit) {
  auto samples = measured(whole_sphere(500));
  for (Vector& s : samples) {
    for (double& x : s) {
      x *= 1e9;
    }
  }
  const MagFit fit = fit_magnetometer(samples);
  ASSERT_EQ(fit.status, MagFit::Status::kOk);
  EXPECT_NEAR(fit.field, 50e3, 1e-2);
  EXPECT_NEAR(fit.matrix[0][1], Sensor::a(0, 1), 1e-8);
}

}  // namespace
}  // namespace rosflight::companion::test
