// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <initializer_list>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "rosflight_sim/vehicle_views.hpp"
#include "sim/multirotor/multirotor_parameters.hpp"

/// What the views of all vehicles are made of.
namespace rosflight_sim::views {

namespace sim = rosflight::sim;

using Kind = VehicleView::Kind;
using sim::Vehicle;
using Numbers = std::vector<double>;
using Names = std::set<std::string>;
using List = std::vector<VehicleView>;

inline std::string text(double value) {
  std::ostringstream out;
  out.precision(17);
  out << value;
  return out.str();
}

inline std::string text(const Numbers& values) {
  std::string out = "[";
  for (const double value : values) out += (out.size() > 1 ? ", " : "") + text(value);
  return out + "]";
}

inline void add(List& list, std::string name, double min, double max, std::string what,
                std::function<double(const Vehicle&)> get) {
  list.push_back({std::move(name), Kind::kNumber, min, max, std::move(what), true,
                  [get = std::move(get)](const Vehicle& v) { return Numbers{get(v)}; }});
}

/// One number of the vehicle file under its name in ROSflight 2.x. Range, unit and meaning are those
/// of the file's key.
struct KeyView {
  std::string name;
  std::string key;       ///< Whole path, such as "aero.lift.alpha".
  std::size_t index{0};  ///< In a list of numbers.
  double factor{1.0};    ///< Value of the key for a value of 1 of the parameter.
};
using KeyViews = std::vector<KeyView>;

/// A view of a key with a getter of its own, or of each key. @throws std::out_of_range  the file has no such key.
void add(List& list, const KeyView& view, std::function<double(const Vehicle&)> get);
void add(List& list, const KeyViews& views);
/// How those that changed go back; a list of numbers with all its views.
void assign(std::vector<std::string>& out, const KeyViews& views, const ViewValues& all,
            const Names& changed);

inline void add_list(List& list, std::string name, Kind kind, std::string what, bool live,
                     std::function<Numbers(const Vehicle&)> get) {
  list.push_back({std::move(name), kind, -1e9, 1e9, std::move(what), live, std::move(get)});
}

inline bool any(const Names& changed, const std::initializer_list<const char*>& names) {
  for (const char* name : names)
    if (changed.count(name) != 0) return true;
  return false;
}

/// Rotors of a multirotor, propulsion of a fixed wing.
sim::MultirotorParameters rotors_of(const Vehicle& v);

/// Propeller, motor and supply voltage, and how they go back.
void add_propulsion(List& list);
void assign_propulsion(std::vector<std::string>& out, const ViewValues& all, const Names& changed);

/// Density of the air; `rho` goes back with assign_propulsion().
void add_density(List& list);

}  // namespace rosflight_sim::views
