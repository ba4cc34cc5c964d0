// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/magnetic_model.hpp"

#include <chrono>
#include <cmath>
#include <sstream>
#include <string>

#include "base/constants.hpp"
#include "config/strict_yaml.hpp"
#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

constexpr double kReferenceRadius_m = 6371200.0;
using base::kRadPerDeg;

config::Error fault(std::string_view name, int line, const std::string& found,
                    const std::string& allowed) {
  return config::Error(std::string(name) + ":" + std::to_string(line) + ": found " + found +
                       ", allowed " + allowed);
}

}  // namespace

MagneticModel::MagneticModel(std::string_view text, std::string_view name) {
  std::istringstream lines{std::string(text)};
  std::string line;
  int number = 1;
  if (!std::getline(lines, line) || !(std::istringstream(line) >> epoch_)) {
    throw fault(name, number, "no epoch", "a year");
  }
  std::array<bool, kTerms> seen{};
  while (std::getline(lines, line)) {
    ++number;
    if (line.starts_with("9999")) break;
    std::istringstream fields(line);
    int n = 0;
    int m = 0;
    Term term;
    if (!(fields >> n >> m >> term.g_nT >> term.h_nT >> term.g_rate_nT >> term.h_rate_nT)) {
      throw fault(name, number, "\"" + line + "\"", "n m g h dg/dt dh/dt");
    }
    if (n < 1 || n > kDegree || m < 0 || m > n || seen[index(n, m)]) {
      throw fault(name, number, "term " + std::to_string(n) + " " + std::to_string(m),
                  "each of 1 0 to 12 12 once");
    }
    seen[index(n, m)] = true;
    terms_[index(n, m)] = term;
  }
  for (std::size_t i = 1; i < kTerms; ++i) {
    if (!seen[i]) throw fault(name, number, "a missing term", "all terms to degree 12");
  }
}

Vector3 MagneticModel::field_W_T(const Geodetic& position, double year) const {
  // Geocentric colatitude and radius from ECEF.
  const Vector3 ecef = to_ecef(position);
  const double across = std::sqrt(ecef.x() * ecef.x() + ecef.y() * ecef.y());
  const double radius = std::sqrt(across * across + ecef.z() * ecef.z());
  const double c = ecef.z() / radius;  // cos colatitude = sin phi'
  const double s =
      std::max(across / radius, 1e-10);  // sin colatitude; a pole is approached to 0.6 mm

  // Schmidt semi-normalised P and dP/dcolatitude by recursion over the degree.
  std::array<double, kTerms> p{};
  std::array<double, kTerms> dp{};
  p[0] = 1.0;
  for (int n = 1; n <= kDegree; ++n) {
    for (int m = 0; m <= n; ++m) {
      const auto i = index(n, m);
      if (n == m) {
        const double k = n == 1 ? 1.0 : std::sqrt(1.0 - 0.5 / n);
        p[i] = k * s * p[index(n - 1, n - 1)];
        dp[i] = k * (s * dp[index(n - 1, n - 1)] + c * p[index(n - 1, n - 1)]);
        continue;
      }
      const double norm = std::sqrt(static_cast<double>(n * n - m * m));
      const double a = (2 * n - 1) / norm;
      const auto one = index(n - 1, m);
      p[i] = a * c * p[one];
      dp[i] = a * (c * dp[one] - s * p[one]);
      if (n - 2 >= m) {
        const double b = std::sqrt(static_cast<double>((n - 1) * (n - 1) - m * m)) / norm;
        p[i] -= b * p[index(n - 2, m)];
        dp[i] -= b * dp[index(n - 2, m)];
      }
    }
  }

  const double dt = year - epoch_;
  const auto lon = portable::sin_cos(position.longitude_deg * kRadPerDeg);
  const double ratio = kReferenceRadius_m / radius;
  double power = ratio * ratio;
  double north = 0.0;  // in the geocentric frame, nT
  double east = 0.0;
  double down = 0.0;
  for (int n = 1; n <= kDegree; ++n) {
    power *= ratio;
    double cos_m = 1.0;
    double sin_m = 0.0;
    for (int m = 0; m <= n; ++m) {
      const auto i = index(n, m);
      const Term& t = terms_[i];
      const double g = t.g_nT + dt * t.g_rate_nT;
      const double h = t.h_nT + dt * t.h_rate_nT;
      const double even = g * cos_m + h * sin_m;
      north += power * even * dp[i];
      east += power * m * (g * sin_m - h * cos_m) * p[i] / s;
      down -= power * (n + 1) * even * p[i];
      const double next = cos_m * lon.cos - sin_m * lon.sin;
      sin_m = sin_m * lon.cos + cos_m * lon.sin;
      cos_m = next;
    }
  }

  // From the geocentric to the geodetic vertical: rotate by phi' - phi about east.
  const auto lat = portable::sin_cos(position.latitude_deg * kRadPerDeg);
  const double sin_d = c * lat.cos - s * lat.sin;
  const double cos_d = s * lat.cos + c * lat.sin;
  return 1e-9 * Vector3(north * cos_d - down * sin_d, east, north * sin_d + down * cos_d);
}

const MagneticModel& wmm2025() {
  static const MagneticModel model(kWmm2025Text, "WMM2025.COF");
  return model;
}

double decimal_year(std::int64_t unix_s) {
  using std::chrono::days;
  using std::chrono::seconds;
  using std::chrono::sys_days;
  const std::chrono::sys_seconds time{seconds{unix_s}};
  const std::chrono::year_month_day date{std::chrono::floor<days>(time)};
  const auto first = [](std::chrono::year y) { return sys_days{y / std::chrono::January / 1}; };
  const auto start = first(date.year());
  const auto length = first(date.year() + std::chrono::years{1}) - start;
  const double in_year = static_cast<double>((time - start).count());
  return static_cast<double>(static_cast<int>(date.year())) +
         in_year / (86400.0 * static_cast<double>(length.count()));
}

}  // namespace rosflight::sim
