// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>

#include "flight/flight.hpp"
#include "flight/gazebo/coupling/link_loop.hpp"

namespace rosflight::flight::gazebo {

/// A whole flight around a link: firmware, forces, sensors, companion and autonomy in this thread, in lock-step with
/// the simulator, which moves the body. The same flight as `./rosflight fly --physics gazebo --world`, step by step.
///
/// The first step puts the vehicle at the origin, on its gear. From then on each step of the firmware is one or several of the
/// simulator: sensors, firmware and forces before the first of them, with the load held; the new state after the last.
/// Contacts are what the change of velocity shows beside load and gravity, so a crash is known by its speed, not by the part
/// that hits. When the flight is over, one line says how it went; the vehicle then stands as it is.
class WholeLoop final : public LinkLoop {
 public:
  struct Options {
    FlightChoice choice;
    sim::Vector3 centre_of_mass_L{sim::Vector3::Zero()};
    std::filesystem::path log_file;  ///< MCAP; empty: none.
    std::optional<Run> at_end;       ///< Empty: the simulator runs on.
  };

  /// @throws config::Error  one line: vehicle, mission, a choice that is not of this process.
  /// @throws log::LogError  the log cannot be written.
  WholeLoop(Options options, LinkCoupling::Say say);
  ~WholeLoop() override;

  StepCommand before_step(std::chrono::nanoseconds step) override;
  void after_step(const LinkState& state) override;

  const Flight& flight() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace rosflight::flight::gazebo
