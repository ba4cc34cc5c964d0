// SPDX-License-Identifier: BSD-3-Clause
#include "config/table.hpp"
#include "sim/parameter_tables.hpp"

namespace rosflight::sim {
namespace {

/// Adds points, three numbers each.
void append(std::vector<Vector3>& points, const std::vector<double>& values) {
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    points.emplace_back(values[i], values[i + 1], values[i + 2]);
}

std::vector<double> coordinates(const std::vector<Vector3>& points, std::size_t first,
                                std::size_t last) {
  std::vector<double> all;
  for (std::size_t i = first; i < last; ++i)
    all.insert(all.end(), points[i].data(), points[i].data() + 3);
  return all;
}

}  // namespace

config::Table<GroundParameters> ground_parameters() {
  using config::Range;
  using G = GroundParameters;
  using R = config::Row<G>;
  const Range extent = Range::between(-20.0, 20.0);
  const std::string when = "with the model contact";
  // Checked whatever the model, so that another one can be chosen from the command line alone.
  const auto contact = [](const G& g) {
    return g.model == GroundModel::kContact || !g.contacts_B.empty();
  };
  return {
      R{"model",
        &G::model,
        {{"contact", GroundModel::kContact},
         {"frictionless_plane", GroundModel::kFrictionlessPlane},
         {"none", GroundModel::kNone}},
        "frictionless_plane: as ROSflight 2.x"}
          .needed(),
      R{"contacts_m", config::Points{},
        [](const G& g) { return coordinates(g.contacts_B, 0, g.contacts_B.size() - g.wheels); },
        [](G& g, const std::vector<double>& values) { append(g.contacts_B, values); }, "m", extent,
        "points of the airframe that may touch"}
          .needed_if(when, contact)
          .must("one or more",
                [](const G& g) {
                  return g.model != GroundModel::kContact || g.contacts_B.size() > g.wheels;
                }),
      R{"stiffness_N_m", &G::stiffness_N_m, "N/m", Range::positive_up_to(1e7), "of each contact"}
          .needed_if(when, contact),
      R{"damping_N_s_m", &G::damping_N_s_m, "N s/m", Range::between(0.0, 1e6), "of each contact"}
          .needed_if(when, contact),
      R{"friction_stiffness_N_m", &G::friction_stiffness_N_m, "N/m", Range::positive_up_to(1e7),
        "in the plane, while it sticks"}
          .needed_if(when, contact),
      R{"friction_damping_N_s_m", &G::friction_damping_N_s_m, "N s/m", Range::between(0.0, 1e6),
        "in the plane, while it sticks"}
          .needed_if(when, contact),
      R{"friction", &G::friction, "", Range::between(0.0, 10.0),
        "Coulomb's coefficient; of a wheel across its direction"}
          .needed_if(when, contact),
      R{"wheels_m", config::Points{},
        [](const G& g) {
          return coordinates(g.contacts_B, g.contacts_B.size() - g.wheels, g.contacts_B.size());
        },
        [](G& g, const std::vector<double>& values) {
          append(g.contacts_B, values);
          g.wheels = values.size() / 3;
        },
        "m", extent, "contacts that roll along body x"}
          .if_absent("none"),
      R{"rolling_friction", &G::rolling_friction, "", Range::between(0.0, 10.0),
        "of a wheel along its direction"}
          .needed_if("with wheels", [](const G& g) { return g.wheels > 0; })};
}

GroundParameters read_ground(const config::Section& section) {
  GroundParameters p;
  ground_parameters().read(section, p);
  section.finish();
  return p;
}

}  // namespace rosflight::sim
