// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <nanobind/nanobind.h>

/// What the files of this folder add to the module rosflight._core.
namespace rosflight::python {

void bind_fly(nanobind::module_& m);
void bind_simulation(nanobind::module_& m);
void bind_vehicles(nanobind::module_& m);

}  // namespace rosflight::python
