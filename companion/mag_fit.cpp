// SPDX-License-Identifier: BSD-3-Clause
#include "companion/mag_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <utility>
#include <vector>

#include "base/constants.hpp"

namespace rosflight::companion {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix10 = Eigen::Matrix<double, 10, 10>;
using Vector10 = Eigen::Matrix<double, 10, 1>;
using Points = std::vector<Vector3d>;

constexpr int kIterations = 50;
constexpr double kConverged = 1e-12;
constexpr std::size_t kBands = 6;
constexpr std::size_t kSectors = 12;

Vector3d to_eigen(const MagFit::Vector& v) {
  return {v[0], v[1], v[2]};
}

/// Ellipsoid |W (x - b)| = 1.
struct Ellipsoid {
  Matrix3d w{Matrix3d::Identity()};
  Vector3d b{Vector3d::Zero()};
};

/// Points moved to their centroid and scaled to rms 1.
struct Normalised {
  Vector3d centre{Vector3d::Zero()};
  double scale{1.0};
  Points points;
};

Normalised normalise(std::span<const MagFit::Vector> samples) {
  Normalised n;
  for (const MagFit::Vector& s : samples) {
    n.centre += to_eigen(s);
  }
  n.centre /= static_cast<double>(samples.size());
  double sum = 0.0;
  for (const MagFit::Vector& s : samples) {
    n.points.push_back(to_eigen(s) - n.centre);
    sum += n.points.back().squaredNorm();
  }
  n.scale = std::sqrt(sum / static_cast<double>(samples.size()));
  for (Vector3d& p : n.points) {
    p /= n.scale;
  }
  return n;
}

bool algebraic_fit(const Points& points, Ellipsoid& result) {
  Matrix10 scatter = Matrix10::Zero();
  for (const Vector3d& p : points) {
    Vector10 row;
    row << p.x() * p.x(), 2 * p.x() * p.y(), 2 * p.x() * p.z(), p.y() * p.y(), 2 * p.y() * p.z(),
        p.z() * p.z(), 2 * p.x(), 2 * p.y(), 2 * p.z(), 1.0;
    scatter += row * row.transpose();
  }
  const Vector10 v = Eigen::SelfAdjointEigenSolver<Matrix10>(scatter).eigenvectors().col(0);
  Matrix3d m;
  m << v(0), v(1), v(2), v(1), v(3), v(4), v(2), v(4), v(5);
  const Vector3d n(v(6), v(7), v(8));
  const Eigen::FullPivLU<Matrix3d> lu(m);
  if (!lu.isInvertible()) {
    return false;
  }
  // (x - b)' M (x - b) = n' M^-1 n - v9: positive definite after division, if it is an ellipsoid.
  result.b = -lu.solve(n);
  const double constant = -n.dot(result.b) - v(9);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(m / constant);
  if (!(eigen.eigenvalues().minCoeff() > 0.0)) {
    return false;
  }
  result.w = eigen.operatorSqrt();
  return result.w.allFinite();
}

struct Linearised {
  Matrix9 normal{Matrix9::Zero()};
  Vector9 gradient{Vector9::Zero()};
  double cost{0.0};
};

/// (2) and its Gauss-Newton matrices, mean over the points. Unknowns: W11 W12 W13 W22 W23 W33 b1 b2
/// b3.
Linearised linearise(const Points& points, const Ellipsoid& e) {
  Linearised result;
  for (const Vector3d& p : points) {
    const Vector3d d = p - e.b;
    const Vector3d y = e.w * d;
    const double norm = std::max(y.norm(), 1e-9);
    const Vector3d u = y / norm;
    const Vector3d to_b = -(e.w * u);
    Vector9 row;
    row << u.x() * d.x(), u.x() * d.y() + u.y() * d.x(), u.x() * d.z() + u.z() * d.x(),
        u.y() * d.y(), u.y() * d.z() + u.z() * d.y(), u.z() * d.z(), to_b.x(), to_b.y(), to_b.z();
    const double r = norm - 1.0;
    result.normal += row * row.transpose();
    result.gradient += row * r;
    result.cost += r * r;
  }
  const auto count = static_cast<double>(points.size());
  result.normal /= count;
  result.gradient /= count;
  result.cost /= count;
  return result;
}

Ellipsoid moved(const Ellipsoid& e, const Vector9& step) {
  Ellipsoid result = e;
  Matrix3d dw;
  dw << step(0), step(1), step(2), step(1), step(3), step(4), step(2), step(4), step(5);
  result.w += dw;
  result.b += step.tail<3>();
  return result;
}

/// Levenberg-Marquardt. @returns false if it does not settle.
bool refine(const Points& points, Ellipsoid& e, Linearised& at_end) {
  double damping = 1e-3;
  Linearised here = linearise(points, e);
  for (int i = 0; i < kIterations; ++i) {
    Matrix9 damped = here.normal;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-15;
    const Vector9 step = -damped.ldlt().solve(here.gradient);
    if (!step.allFinite()) {
      return false;
    }
    const Ellipsoid candidate = moved(e, step);
    const Linearised there = linearise(points, candidate);
    if (there.cost <= here.cost) {
      const bool settled = step.squaredNorm() < kConverged;
      e = candidate;
      here = there;
      damping = std::max(damping / 10.0, 1e-9);
      if (settled) {
        at_end = std::move(here);
        return true;
      }
    } else {
      if (step.squaredNorm() < kConverged) {
        at_end = std::move(here);
        return true;
      }
      damping *= 10.0;
    }
  }
  return false;
}

/// Cells of equal area: bands of equal height, each cut in equal sectors.
double coverage_of(const Points& points, const Ellipsoid& e) {
  std::bitset<kBands * kSectors> hit;
  for (const Vector3d& p : points) {
    const Vector3d u = (e.w * (p - e.b)).normalized();
    const double band = (u.z() + 1.0) / 2.0 * static_cast<double>(kBands);
    const double sector =
        (std::atan2(u.y(), u.x()) / (2.0 * base::kPi) + 0.5) * static_cast<double>(kSectors);
    const auto cell = [](double x, std::size_t n) {
      return std::min(static_cast<std::size_t>(std::max(x, 0.0)), n - 1);
    };
    hit.set(cell(band, kBands) * kSectors + cell(sector, kSectors));
  }
  return static_cast<double>(hit.count()) / static_cast<double>(hit.size());
}

double raw_residual_of(std::span<const MagFit::Vector> samples) {
  double sum = 0.0;
  double squares = 0.0;
  for (const MagFit::Vector& s : samples) {
    const double norm = to_eigen(s).norm();
    sum += norm;
    squares += norm * norm;
  }
  const auto count = static_cast<double>(samples.size());
  const double mean = sum / count;
  return mean > 0.0 ? std::sqrt(std::max(squares / count - mean * mean, 0.0)) / mean : 0.0;
}

}  // namespace

MagFit::Vector MagFit::corrected(const Vector& sample) const {
  Vector result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      result[i] += matrix[i][j] * (sample[j] - bias[j]);
    }
  }
  return result;
}

const char* mag_fit_status_text(MagFit::Status status) {
  switch (status) {
    case MagFit::Status::kOk:
      return "good";
    case MagFit::Status::kTooFewSamples:
      return "too few samples";
    case MagFit::Status::kNotFinite:
      return "samples that are no numbers";
    case MagFit::Status::kUndetermined:
      return "attitudes too alike: turn through all of them";
    case MagFit::Status::kNoEllipsoid:
      return "samples do not lie on an ellipsoid";
    case MagFit::Status::kPoorFit:
      return "field disturbed: residual too large";
  }
  return "";
}

MagFit fit_magnetometer(std::span<const MagFit::Vector> samples, const MagFit::Limits& limits) {
  MagFit fit;
  const auto refuse = [&fit](MagFit::Status status) {
    fit.status = status;
    return fit;
  };
  if (samples.size() < std::max<std::size_t>(limits.min_samples, 10)) {
    return refuse(MagFit::Status::kTooFewSamples);
  }
  if (!std::all_of(samples.begin(), samples.end(),
                   [](const MagFit::Vector& s) { return to_eigen(s).allFinite(); })) {
    return refuse(MagFit::Status::kNotFinite);
  }
  fit.raw_residual = raw_residual_of(samples);
  const Normalised n = normalise(samples);
  if (!(n.scale > 0.0)) {
    return refuse(MagFit::Status::kUndetermined);
  }
  Ellipsoid e;
  Linearised end;
  const bool converged = algebraic_fit(n.points, e) && refine(n.points, e, end);
  if (!converged) {
    // Say why, if flat samples are the reason: a sphere of the right size shows what they
    // determine.
    const Linearised sphere = linearise(n.points, {});
    fit.determination = Eigen::SelfAdjointEigenSolver<Matrix9>(sphere.normal).eigenvalues()(0);
    return refuse(fit.determination < limits.determination ? MagFit::Status::kUndetermined
                                                           : MagFit::Status::kNoEllipsoid);
  }
  fit.determination = Eigen::SelfAdjointEigenSolver<Matrix9>(end.normal).eigenvalues()(0);
  fit.residual = std::sqrt(end.cost);
  fit.coverage = coverage_of(n.points, e);
  const double det = e.w.determinant();
  if (fit.determination < limits.determination) {
    return refuse(MagFit::Status::kUndetermined);
  }
  if (!(det > 0.0) ||
      !(Eigen::SelfAdjointEigenSolver<Matrix3d>(e.w).eigenvalues().minCoeff() > 0.0)) {
    return refuse(MagFit::Status::kNoEllipsoid);
  }
  const double root = std::cbrt(det);
  const Vector3d bias = n.centre + n.scale * e.b;
  for (int i = 0; i < 3; ++i) {
    const auto row = static_cast<std::size_t>(i);
    fit.bias[row] = bias(i);
    for (int j = 0; j < 3; ++j) {
      fit.matrix[row][static_cast<std::size_t>(j)] = e.w(i, j) / root;
    }
  }
  fit.field = n.scale / root;
  return refuse(fit.residual > limits.max_residual ? MagFit::Status::kPoorFit
                                                   : MagFit::Status::kOk);
}

}  // namespace rosflight::companion
