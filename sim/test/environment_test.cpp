// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/environment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "sim/environment/magnetic_model.hpp"

namespace rosflight::sim {
namespace {

TEST(Atmosphere, MatchesThePublishedTable) {
  // U.S. Standard Atmosphere 1976, table I: geometric height, temperature, pressure, density; five
  // digits printed.
  struct Row {
    double height_m, temperature_K, pressure_Pa, density_kg_m3;
  };
  const Atmosphere air;
  for (const Row& row :
       {Row{-1000, 294.651, 1.1393e5, 1.3470}, Row{0, 288.150, 1.01325e5, 1.2250},
        Row{1000, 281.651, 8.9876e4, 1.1117}, Row{2000, 275.154, 7.9501e4, 1.0066},
        Row{3000, 268.659, 7.0121e4, 9.0925e-1}, Row{5000, 255.676, 5.4048e4, 7.3643e-1},
        Row{10000, 223.252, 2.6499e4, 4.1351e-1}, Row{11000, 216.774, 2.2699e4, 3.6480e-1},
        Row{20000, 216.650, 5.5293e3, 8.8910e-2}, Row{30000, 226.509, 1.1970e3, 1.8410e-2}}) {
    const AirProperties now = air.at(row.height_m);
    EXPECT_NEAR(now.temperature_K, row.temperature_K, 6e-4) << row.height_m;
    EXPECT_NEAR(now.pressure_Pa / row.pressure_Pa, 1.0, 6e-5) << row.height_m;
    EXPECT_NEAR(now.density_kg_m3 / row.density_kg_m3, 1.0, 6e-5) << row.height_m;
  }
}

TEST(Atmosphere, MeetsThePressuresBetweenTheLayers) {
  // U.S. Standard Atmosphere 1976: pressures at the geopotential heights where layers meet.
  for (const auto& [geopotential_m, pressure_Pa] : {std::pair{11000.0, 22632.06},
                                                    {20000.0, 5474.889},
                                                    {32000.0, 868.0187},
                                                    {47000.0, 110.9063}}) {
    const double height_m = 6356766.0 * geopotential_m / (6356766.0 - geopotential_m);
    EXPECT_NEAR(Atmosphere().at(height_m).pressure_Pa / pressure_Pa, 1.0, 6e-7) << geopotential_m;
  }
}

TEST(Atmosphere, StaysInHydrostaticBalanceOnAnyDay) {
  AtmosphereParameters hot;
  hot.temperature_offset_K = 20.0;
  hot.sea_level_pressure_Pa = 99000.0;
  const Atmosphere air(hot);
  EXPECT_NEAR(air.at(0.0).pressure_Pa, 99000.0, 1e-9);
  EXPECT_NEAR(air.at(1000.0).temperature_K, 281.651 + 20.0, 1e-3);
  for (const double h : {100.0, 5000.0, 10995.0, 15000.0, 25000.0}) {
    const double slope = (air.at(h + 5.0).pressure_Pa - air.at(h - 5.0).pressure_Pa) / 10.0;
    const double r = 6356766.0 / (6356766.0 + h);
    // dp/dh = -rho g(h); the central difference errs by (5 m)^2 p'''/6, below 2e-7 of it.
    EXPECT_NEAR(slope / (-air.at(h).density_kg_m3 * 9.80665 * r * r), 1.0, 1e-6) << h;
  }
}

TEST(Atmosphere, ReferenceFormulaGivesItsCheckValues) {
  AtmosphereParameters p;
  p.model = AtmosphereModel::kReference;
  // ROSflight 2.x simulator at its origin height.
  const AirProperties air = Atmosphere(p).at(1387.0);
  EXPECT_NEAR(air.pressure_Pa, 85729.12, 0.005);
  EXPECT_NEAR(air.density_kg_m3, 1.06994, 5e-6);
}

TEST(Atmosphere, ConstantDensityLeavesPressureAlone) {
  AtmosphereParameters p;
  p.model = AtmosphereModel::kConstant;
  p.constant_density_kg_m3 = 1.1;
  const Atmosphere air(p);
  EXPECT_EQ(air.at(3000.0).density_kg_m3, 1.1);
  EXPECT_EQ(air.at(3000.0).pressure_Pa, Atmosphere().at(3000.0).pressure_Pa);
}

TEST(Atmosphere, StaysFiniteFarOutside) {
  for (const auto model : {AtmosphereModel::kStandard1976, AtmosphereModel::kReference}) {
    AtmosphereParameters p;
    p.model = model;
    for (const double h : {-1e300, -6356766.0, -5000.0, 60e3, 1e6, 1e300, std::nan("")}) {
      const AirProperties air = Atmosphere(p).at(h);
      EXPECT_TRUE(std::isfinite(air.pressure_Pa) && air.pressure_Pa >= 0.0) << h;
      EXPECT_TRUE(std::isfinite(air.density_kg_m3) && air.density_kg_m3 >= 0.0) << h;
    }
  }
}

TEST(Geodesy, EcefMatchesGeographicLib) {
  // CartConvert of GeographicLib (examples of its manual page), printed to 1 cm and 1 mm.
  const Vector3 p = to_ecef({33.3, 44.4, 6000.0});
  EXPECT_NEAR(p.x(), 3816209.60, 0.005);
  EXPECT_NEAR(p.y(), 3737108.55, 0.005);
  EXPECT_NEAR(p.z(), 3485109.57, 0.005);
  const LocalFrame frame({33.0, 44.0, 20.0});
  const Vector3 local = frame.to_local({33.3, 44.4, 6000.0});
  EXPECT_NEAR(local.y(), 37288.97, 0.005);
  EXPECT_NEAR(local.x(), 33374.29, 0.005);
  EXPECT_NEAR(-local.z(), 5783.65, 0.005);
  const Vector3 pole = to_ecef({90.0, 0.0, 0.0});
  EXPECT_NEAR(pole.z(), 6356752.314245, 1e-6);  // TR8350.2: semi-minor axis
  EXPECT_NEAR(pole.x(), 0.0, 1e-9);
}

TEST(Geodesy, GoesThereAndBack) {
  for (const double lat : {-90.0, -89.9, -45.0, 0.0, 1e-7, 40.2463724, 89.99999, 90.0}) {
    for (const double lon : {-179.999, -111.6474138, 0.0, 90.0, 180.0}) {
      for (const double h : {-100.0, 0.0, 1387.0, 12000.0}) {
        const Geodetic back = to_geodetic(to_ecef({lat, lon, h}));
        EXPECT_NEAR(back.latitude_deg, lat, 1e-12) << lat << ' ' << lon << ' ' << h;
        EXPECT_NEAR(back.altitude_m, h, 1e-8) << lat << ' ' << lon << ' ' << h;
        if (std::abs(lat) < 90.0) {
          EXPECT_NEAR(back.longitude_deg, lon, 1e-9) << lat;
        }
      }
    }
  }
  const LocalFrame frame({40.2463724, -111.6474138, 1387.0});
  const Vector3 p_W(1234.5, -678.9, -120.0);
  EXPECT_LT((frame.to_local(frame.to_geodetic(p_W)) - p_W).norm(), 2e-8);
  // A hundred metres north raise the latitude by 100 m over the meridian radius M + h.
  const double e2 = 0.00669437999014;
  const double s = std::sin(40.2463724 * M_PI / 180.0);
  const double meridian = 6378137.0 * (1 - e2) / std::pow(1 - e2 * s * s, 1.5) + 1387.0;
  const double step_deg = frame.to_geodetic({100.0, 0.0, 0.0}).latitude_deg - 40.2463724;
  EXPECT_NEAR(step_deg, 100.0 / meridian * 180.0 / M_PI, 1e-10);
}

TEST(MagneticModel, MatchesPublishedAndIndependentValues) {
  // Rows 1-4: test table of the WMM2025 report; row 5: PyPI pygeomag 1.1.0. Printed to 0.1 nT.
  struct Row {
    Geodetic place;
    double year, x_nT, y_nT, z_nT;
  };
  const MagneticModel model = wmm2025();
  EXPECT_EQ(model.epoch(), 2025.0);
  for (const Row& row : {Row{{80, 0, 0}, 2025.0, 6521.6, 145.9, 54791.5},
                         Row{{0, 120, 0}, 2025.0, 39677.8, -109.6, -10580.2},
                         Row{{-80, 240, 0}, 2025.0, 6117.5, 15751.9, -52022.5},
                         Row{{80, 0, 100e3}, 2025.0, 6216.0, 92.4, 52598.8},
                         Row{{40.2518, -111.6493, 1387}, 2026.9, 20818.5, 3861.3, 45736.7}}) {
    const Vector3 field = 1e9 * model.field_W_T(row.place, row.year);
    EXPECT_NEAR(field.x(), row.x_nT, 0.051);
    EXPECT_NEAR(field.y(), row.y_nT, 0.051);
    EXPECT_NEAR(field.z(), row.z_nT, 0.051);
  }
}

TEST(MagneticModel, AgreesWithAnotherProgramAllOverTheEarth) {
  // PyPI pygeomag 1.1.0 with its WMM_2025.COF at random places, heights and days; printed to 0.01
  // nT.
  struct Row {
    Geodetic place;
    double year, x_nT, y_nT, z_nT;
  };
  const MagneticModel model = wmm2025();
  for (const Row& row : {Row{{-65.083, 125.076, 37953}, 2026.25, -1458.80, -3341.17, -64584.05},
                         Row{{-0.813, -18.183, 32231}, 2028.86, 24558.73, -4681.74, -14624.05},
                         Row{{-72.293, -169.795, 41624}, 2027.12, 650.06, 11518.36, -58820.56},
                         Row{{46.686, -179.242, 21715}, 2028.54, 23467.53, 1113.30, 39340.17},
                         Row{{-48.28, 160.297, 44973}, 2025.15, 14682.86, 7110.98, -58253.47},
                         Row{{-84.471, 14.908, 46897}, 2026.87, 13584.54, -11502.22, -45933.08},
                         Row{{-50.445, -28.038, 481}, 2026.09, 13031.29, -2765.15, -21754.88},
                         Row{{-11.056, -1.508, 10887}, 2026.13, 18303.26, -3043.78, -23599.06}}) {
    const Vector3 field = 1e9 * model.field_W_T(row.place, row.year);
    EXPECT_NEAR(field.x(), row.x_nT, 0.0051);
    EXPECT_NEAR(field.y(), row.y_nT, 0.0051);
    EXPECT_NEAR(field.z(), row.z_nT, 0.0051);
  }
}

TEST(MagneticModel, IsContinuousAtThePoles) {
  const MagneticModel model = wmm2025();
  for (const double pole : {90.0, -90.0}) {
    const Vector3 at = model.field_W_T({pole, 30.0, 0.0}, 2026.0);
    const Vector3 near = model.field_W_T({std::copysign(89.999, pole), 30.0, 0.0}, 2026.0);
    EXPECT_LT((at - near).norm(), 5e-9);  // 111 m away; the field changes by some nT per km
  }
}

TEST(MagneticModel, RejectsBrokenCoefficientFiles) {
  EXPECT_THROW(MagneticModel("", "f"), config::Error);
  EXPECT_THROW(MagneticModel("x y", "f"), config::Error);
  EXPECT_THROW(MagneticModel("2025.0 M\n 1 0 1 2 3\n", "f"), config::Error);
  EXPECT_THROW(MagneticModel("2025.0 M\n 13 0 1 2 3 4\n", "f"), config::Error);
  EXPECT_THROW(MagneticModel("2025.0 M\n 1 0 1 2 3 4\n 1 0 1 2 3 4\n", "f"), config::Error);
  try {
    MagneticModel("2025.0 M\n 1 0 1 2 3 4\n9999\n", "f");
    ADD_FAILURE();
  } catch (const config::Error& error) {
    EXPECT_STREQ(error.what(), "f:3: found a missing term, allowed all terms to degree 12");
  }
}

TEST(Calendar, YearsAndUtcTexts) {
  EXPECT_EQ(parse_utc("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(parse_utc("2026-06-01T12:00:00Z"), 1780315200);  // date -u -d ... +%s
  for (const char* bad :
       {"2026-02-30T00:00:00Z", "2026-06-01", "2026-06-01T24:00:00Z", "2026-06-01 12:00:00Z", ""}) {
    EXPECT_FALSE(parse_utc(bad).has_value()) << bad;
  }
  EXPECT_EQ(decimal_year(1735689600), 2025.0);
  EXPECT_NEAR(decimal_year(1735689600 + 365 * 43200), 2025.5, 1e-12);
}

const std::string kEnvironment =
    "origin: {latitude_deg: 40.2518, longitude_deg: -111.6493, altitude_m: 1387}\n"
    "start_utc: 2026-06-01T12:00:00Z\n"
    "gravity_m_s2: 9.80665\n"
    "atmosphere: {model: standard}\n";

EnvironmentParameters read(const std::string& text) {
  return read_environment(config::Document::from_text(text, "e.yaml").root());
}

std::string message_of(const std::string& text) {
  try {
    read(text);
  } catch (const config::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Environment, ReadsItsSection) {
  const EnvironmentParameters p = read(kEnvironment +
                                       "wind: {steady_W_m_s: [1, 2, 3], turbulence_w20_m_s: 7.7, "
                                       "gusts: {mean_interval_s: 5}}\n");
  EXPECT_EQ(p.origin.longitude_deg, -111.6493);
  EXPECT_EQ(p.wind.steady_W_m_s, Vector3(1, 2, 3));
  EXPECT_EQ(p.wind.gusts.mean_interval_s, 5.0);
  // WMM2025 at 2026.4 lies between its values for 2025 and 2030, near 20.8 uT north.
  EXPECT_NEAR(p.magnetic_field_W_T.x(), 20.82e-6, 0.05e-6);
  EXPECT_EQ(read(kEnvironment + "magnetic_field_W_T: [1e-5, 0, 2e-5]").magnetic_field_W_T,
            Vector3(1e-5, 0, 2e-5));
  const EnvironmentParameters former =
      read(kEnvironment + "magnetic_field_N_T: [1e-5, 0, 2e-5]\n" +
           "wind: {steady_N_m_s: [1, 2, 3], random_std_N_m_s: [4, 5, 6], "
           "gusts: {mean_interval_s: 5, shortest_s: 6, longest_s: 7}}\n");
  EXPECT_EQ(former.magnetic_field_W_T, Vector3(1e-5, 0, 2e-5));
  EXPECT_EQ(former.wind.steady_W_m_s, Vector3(1, 2, 3));
  EXPECT_EQ(former.wind.random_std_W_m_s, Vector3(4, 5, 6));
  EXPECT_EQ(former.wind.gusts.min_s, 6.0);
  EXPECT_EQ(former.wind.gusts.max_s, 7.0);
}

TEST(Environment, RejectsWhatCannotBe) {
  EXPECT_EQ(message_of(kEnvironment + "wind: {steady: [1, 2, 3]}"),
            "e.yaml:5: wind.steady: found an unknown key, allowed steady_W_m_s, random_std_W_m_s, "
            "turbulence_w20_m_s, gusts");
  EXPECT_EQ(message_of(kEnvironment + "wind: {gusts: {mean_interval_s: 5, min_s: 6, max_s: 5.5}}"),
            "e.yaml:5: wind.gusts.max_s: found 5.5, allowed a number from 6 to 600");
  EXPECT_EQ(message_of("origin: {latitude_deg: 91, longitude_deg: 0, altitude_m: 0}"),
            "e.yaml:1: origin.latitude_deg: found 91, allowed a number from -90 to 90");
  std::string other = kEnvironment;
  other.replace(other.find("2026-06"), 7, "2031-06");
  EXPECT_EQ(message_of(other),
            "e.yaml:2: start_utc: found 2031-06-01T12:00:00Z, allowed the years 2025 to 2029 of "
            "WMM2025, or "
            "magnetic_field_W_T");
  other.replace(other.find("2031-06"), 7, "2026-13");
  EXPECT_EQ(message_of(other),
            "e.yaml:2: start_utc: found 2026-13-01T12:00:00Z, allowed a time such as "
            "2026-06-01T12:00:00Z");
}

}  // namespace
}  // namespace rosflight::sim
