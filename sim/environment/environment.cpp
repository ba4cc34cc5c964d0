// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/environment.hpp"

#include <charconv>
#include <chrono>
#include <string>

#include "sim/environment/magnetic_model.hpp"

namespace rosflight::sim {
namespace {

using config::Range;
using config::Section;

const Range kWindSpeed = Range::between(-60.0, 60.0);

Vector3 vector3(const Section& section, std::string_view key, Range range,
                const Vector3& if_absent) {
  const auto v = section.numbers(key, 3, range, {if_absent.x(), if_absent.y(), if_absent.z()});
  return {v[0], v[1], v[2]};
}

AtmosphereParameters read_atmosphere(const Section& section) {
  AtmosphereParameters p;
  p.model = section.choice<AtmosphereModel>("model", {{"standard", AtmosphereModel::kStandard1976},
                                                      {"reference", AtmosphereModel::kReference},
                                                      {"constant", AtmosphereModel::kConstant}});
  if (p.model == AtmosphereModel::kConstant) {
    p.constant_density_kg_m3 = section.number("density_kg_m3", Range::positive_up_to(10.0));
  }
  if (p.model != AtmosphereModel::kReference) {
    p.sea_level_pressure_Pa = section.number("sea_level_pressure_Pa", Range::between(85e3, 110e3),
                                             p.sea_level_pressure_Pa);
    p.temperature_offset_K =
        section.number("temperature_offset_K", Range::between(-80.0, 60.0), p.temperature_offset_K);
  }
  return p;
}

WindParameters read_wind(const Section& section) {
  WindParameters p;
  p.steady_N_m_s = vector3(section, "steady_N_m_s", kWindSpeed, p.steady_N_m_s);
  p.random_std_N_m_s =
      vector3(section, "random_std_N_m_s", Range::between(0.0, 20.0), p.random_std_N_m_s);
  p.turbulence_w20_m_s = section.number("turbulence_w20_m_s", Range::between(0.0, 40.0), 0.0);
  if (const auto gusts = section.optional_section("gusts")) {
    GustParameters& g = p.gusts;
    g.mean_interval_s = gusts->number("mean_interval_s", Range::between(0.1, 1e6));
    g.magnitude_mean_m_s =
        gusts->number("magnitude_mean_m_s", Range::between(0.0, 40.0), g.magnitude_mean_m_s);
    g.magnitude_std_m_s =
        gusts->number("magnitude_std_m_s", Range::between(0.0, 20.0), g.magnitude_std_m_s);
    g.direction_std = gusts->number("direction_std", Range::between(0.0, 100.0), g.direction_std);
    g.shortest_s = gusts->number("shortest_s", Range::positive_up_to(600.0), g.shortest_s);
    g.longest_s = gusts->number("longest_s", Range::between(g.shortest_s, 600.0), g.longest_s);
  }
  return p;
}

}  // namespace

std::optional<std::int64_t> parse_utc(std::string_view text) {
  constexpr std::string_view kForm = "dddd-dd-ddTdd:dd:ddZ";
  if (text.size() != kForm.size()) return std::nullopt;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kForm[i] == 'd' ? !digit : text[i] != kForm[i]) return std::nullopt;
  }
  const auto number = [text](std::size_t start, std::size_t length) {
    int value = 0;
    std::from_chars(text.data() + start, text.data() + start + length, value);
    return value;
  };
  namespace c = std::chrono;
  const c::year_month_day date{c::year{number(0, 4)}, c::month{static_cast<unsigned>(number(5, 2))},
                               c::day{static_cast<unsigned>(number(8, 2))}};
  const int hour = number(11, 2);
  const int minute = number(14, 2);
  const int second = number(17, 2);
  if (!date.ok() || hour > 23 || minute > 59 || second > 59) return std::nullopt;
  const auto days = c::sys_days{date}.time_since_epoch().count();
  return std::int64_t{days} * 86400 + std::int64_t{hour * 60 + minute} * 60 + second;
}

EnvironmentParameters read_environment(const config::Section& section) {
  EnvironmentParameters p;
  const Section origin = section.section("origin");
  p.origin.latitude_deg = origin.number("latitude_deg", Range::between(-90.0, 90.0));
  p.origin.longitude_deg = origin.number("longitude_deg", Range::between(-180.0, 180.0));
  p.origin.height_m = origin.number("altitude_m", Range::between(-500.0, 20000.0));

  const auto start = parse_utc(section.text("start_utc"));
  if (!start)
    throw section.error("start_utc", section.raw("start_utc"),
                        "a time such as 2026-06-01T12:00:00Z");
  p.start_unix_s = *start;
  p.gravity_m_s2 = section.number("gravity_m_s2", Range::between(0.0, 30.0));
  p.atmosphere = read_atmosphere(section.section("atmosphere"));
  if (const auto wind = section.optional_section("wind")) p.wind = read_wind(*wind);

  if (section.has("magnetic_field_N_T")) {
    p.magnetic_field_N_T =
        vector3(section, "magnetic_field_N_T", Range::between(-1e-4, 1e-4), Vector3::Zero());
  } else {
    const MagneticModel model = wmm2025();
    const double year = decimal_year(p.start_unix_s);
    if (year < model.epoch() || year > model.end()) {
      throw section.error("start_utc", section.raw("start_utc"),
                          "the years 2025 to 2029 of WMM2025, or magnetic_field_N_T");
    }
    p.magnetic_field_N_T = model.field_N_T(p.origin, year);
  }
  section.finish();
  return p;
}

}  // namespace rosflight::sim
