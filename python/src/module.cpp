// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <string>

#include "base/atomic_file.hpp"
#include "config/strict_yaml.hpp"
#include "flight/build_info.hpp"
#include "flight/project_root.hpp"
#include "python/src/bind.hpp"

namespace nb = nanobind;

namespace {

/// Texts of bad input name an option of the command; in Python it is an argument.
std::string as_argument(std::string text) {
  return text.starts_with("--") ? text.substr(2) : text;
}

void translate(const std::exception_ptr& error, void* /*unused*/) {
  try {
    std::rethrow_exception(error);
  } catch (const rosflight::config::Error& e) {
    PyErr_SetString(PyExc_ValueError, as_argument(e.what()).c_str());
  } catch (const rosflight::base::FileError& e) {
    PyErr_SetString(PyExc_OSError, e.what());
  }
}

}  // namespace

NB_MODULE(_core, m) {
  m.doc() = "The C++ part of rosflight: use the package, not this module.";
  nb::register_exception_translator(translate);
  m.attr("BUILD") = rosflight::flight::build_info_text();
  m.def(
      "data_folder", [] { return rosflight::flight::project_root().string(); },
      "The folder with vehicles/ and missions/ of this package.");
  rosflight::python::bind_fly(m);
  rosflight::python::bind_simulation(m);
  rosflight::python::bind_vehicles(m);
}
