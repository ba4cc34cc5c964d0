// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/environment.hpp"

#include <charconv>
#include <chrono>
#include <string>

#include "config/table.hpp"
#include "sim/environment/magnetic_model.hpp"
#include "sim/parameter_tables.hpp"

namespace rosflight::sim {
namespace {

using config::Range;
using config::Row;
using config::Section;
using config::Table;

Table<Geodetic> origin_table() {
  using G = Geodetic;
  using R = Row<G>;
  return {
      R{"latitude_deg", &G::latitude_deg, "deg", Range::between(-90.0, 90.0), "of the start"}
          .needed(),
      R{"longitude_deg", &G::longitude_deg, "deg", Range::between(-180.0, 180.0), "of the start"}
          .needed(),
      R{"altitude_m", &G::altitude_m, "m", Range::between(-500.0, 20000.0),
        "of the start, above mean sea level"}
          .needed()};
}

Table<AtmosphereParameters> model_table() {
  using A = AtmosphereParameters;
  return {Row<A>{"model",
                 &A::model,
                 {{"standard", AtmosphereModel::kStandard1976},
                  {"reference", AtmosphereModel::kReference},
                  {"constant", AtmosphereModel::kConstant}},
                 "standard: US Standard Atmosphere 1976; reference: that of ROSflight 2.x"}
              .needed()};
}
Table<AtmosphereParameters> density_table() {
  using A = AtmosphereParameters;
  return {Row<A>{"density_kg_m3", &A::constant_density_kg_m3, "kg/m^3", Range::positive_up_to(10.0),
                 "of the model constant only"}
              .needed()};
}
Table<AtmosphereParameters> day_table() {
  using A = AtmosphereParameters;
  return {{"sea_level_pressure_Pa", &A::sea_level_pressure_Pa, "Pa", Range::between(85e3, 110e3),
           "of the day; not of the model reference"},
          {"temperature_offset_K", &A::temperature_offset_K, "K", Range::between(-80.0, 60.0),
           "from the standard, at all altitudes; not of the model reference"}};
}

Table<GustParameters> gust_table() {
  using G = GustParameters;
  using R = Row<G>;
  return Table<G>{
      R{"mean_interval_s", &G::mean_interval_s, "s", Range::between(0.1, 1e6), "between gusts"}
          .needed(),
      {"magnitude_mean_m_s", &G::magnitude_mean_m_s, "m/s", Range::between(0.0, 40.0),
       "of the normal law of the magnitude"},
      {"magnitude_std_m_s", &G::magnitude_std_m_s, "m/s", Range::between(0.0, 20.0),
       "of the normal law of the magnitude"},
      {"direction_std", &G::direction_std, "", Range::between(0.0, 100.0),
       "per axis, added to the direction of the steady wind"},
      R{"min_s", &G::min_s, "s", Range::positive_up_to(600.0), "duration"}.formerly("shortest_s"),
      R{"max_s", &G::max_s, "s", Range::any(), "duration"}
          .within("from min_s to 600", [](const G& g) { return Range::between(g.min_s, 600.0); })
          .formerly("longest_s")}
      .whole();
}

Table<WindParameters> wind_table() {
  using W = WindParameters;
  using R = Row<W>;
  return {
      R{"steady_W_m_s", &W::steady_W_m_s, "m/s", Range::between(-60.0, 60.0), "north, east, down"}
          .formerly("steady_N_m_s"),
      R{"random_std_W_m_s", &W::random_std_W_m_s, "m/s", Range::between(0.0, 20.0),
        "north, east, down; drawn once a run, added to the steady wind"}
          .formerly("random_std_N_m_s"),
      {"turbulence_w20_m_s", &W::turbulence_w20_m_s, "m/s", Range::between(0.0, 40.0),
       "wind 20 ft above ground: 7.7 light, 15.4 moderate, 23.2 severe"},
      {"gusts", &W::gusts, gust_table(), "none without this section"}};
}

Table<EnvironmentParameters> place_table() {
  using E = EnvironmentParameters;
  using R = Row<E>;
  return {R{"origin", &E::origin, origin_table()}.needed(),
          R{"gravity_m_s2", &E::gravity_m_s2, "m/s^2", Range::between(0.0, 30.0), ""}.needed(),
          {"wind", &E::wind, wind_table()}};
}

Table<EnvironmentParameters> field_table() {
  using E = EnvironmentParameters;
  return {Row<E>{"magnetic_field_W_T", &E::magnetic_field_W_T, "T", Range::between(-1e-4, 1e-4),
                 "north, east, down"}
              .if_absent("WMM2025 at origin and start_utc")
              .formerly("magnetic_field_N_T")};
}

void read_atmosphere(const Section& section, AtmosphereParameters& p) {
  model_table().read(section, p);
  if (p.model == AtmosphereModel::kConstant) density_table().read(section, p);
  if (p.model != AtmosphereModel::kReference) day_table().read(section, p);
}

}  // namespace

Table<EnvironmentParameters> environment_parameters() {
  using E = EnvironmentParameters;
  const auto self = [](auto& s) -> auto& { return s; };
  const Table<AtmosphereParameters> atmosphere{
      {"", self, model_table()}, {"", self, density_table()}, {"", self, day_table()}};
  return {{"", self, place_table()},
          {"", self, field_table()},
          {"atmosphere", &E::atmosphere, atmosphere}};
}

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
  place_table().read(section, p);
  const auto start = parse_utc(section.text("start_utc"));
  if (!start)
    throw section.error("start_utc", section.raw("start_utc"),
                        "a time such as 2026-06-01T12:00:00Z");
  p.start_unix_s = *start;
  read_atmosphere(section.section("atmosphere"), p.atmosphere);
  if (section.has("magnetic_field_W_T") || section.has("magnetic_field_N_T")) {
    field_table().read(section, p);
  } else {
    const MagneticModel& model = wmm2025();
    const double year = decimal_year(p.start_unix_s);
    if (year < model.epoch() || year > model.end()) {
      throw section.error("start_utc", section.raw("start_utc"),
                          "the years 2025 to 2029 of WMM2025, or magnetic_field_W_T");
    }
    p.magnetic_field_W_T = model.field_W_T(p.origin, year);
  }
  section.finish();
  return p;
}

}  // namespace rosflight::sim
