// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/other_vehicle.hpp"

#include <chrono>
#include <utility>

#include "companion/parameter_file.hpp"

namespace rosflight::viewer {

OtherVehicle::OtherVehicle(const std::string& link)
    : link_({link, std::chrono::seconds{5}, 1, {}, {}}) {}

void OtherVehicle::set_file(std::filesystem::path file) {
  file_ = std::move(file);
  companion::write_parameter_file(file_, {}, "");
}

void OtherVehicle::step() {
  link_.run_for(std::chrono::milliseconds{1});
  companion::ParameterClient& parameters = link_.session().parameters();
  if (!link_.session().connected()) {
    requested_ = false;
  } else if (!std::exchange(requested_, true)) {
    list_ = parameters.refresh();
  }
  if (list_.pending() || !parameters.complete() || written_ == parameters.revision()) return;
  written_ = parameters.revision();
  companion::write_parameter_file(file_, parameters.table().values(),
                                  link_.session().firmware_version());
}

}  // namespace rosflight::viewer
