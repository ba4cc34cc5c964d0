// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>

#include "autonomy/common/state_estimate.hpp"
#include "firmware/core/firmware.hpp"
#include "flight/autopilot/autopilot.hpp"
#include "flight/flight.hpp"
#include "flight/flight_setup.hpp"
#include "sim/rc/pilot.hpp"

namespace rosflight::flight {

/// A vehicle with its firmware in a closed loop without a mission: its owner steps it, and is companion and
/// pilot. Firmware in this process, every byte over the simulated cable. A function of setup and calls
/// alone, to the bit.
class Simulation final {
 public:
  static constexpr sim::Time kStep = Flight::kStep;

  /// The firmware did not arm, or a parameter was not accepted: the text says why.
  class Error : public std::runtime_error {
   public:
    using std::runtime_error::runtime_error;
  };

  /// A moment of one simulation, to go on from there any number of times.
  class Moment;

  /// Powered up, time 0.
  /// @param setup  must outlive this; its mission is not flown. @throws config::Error  board or link is not
  ///               that of this process, or a module does not accept its configuration.
  explicit Simulation(const FlightSetup& setup);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// What companion and pilot of a mission do from power-up to arming, by the same code: link, parameters of
  /// the vehicle, calibration, storing, arming, and the second after it, in which motors idle. The pilot has given control to the
  /// companion then, and his throttle stick is down. @param stop  asked before each step; true ends it at once.
  /// @throws Error  it did not arm.
  void start(const std::function<bool()>& stop = {});

  /// Advances by kStep.
  void step();
  sim::Time now() const;  ///< Start of the next step.

  const FlightSetup& setup() const;
  const sim::Truth& truth() const;
  /// The outputs of the last step, 0..1 each.
  const hal::OutputValues& outputs() const;
  /// As the companion estimates it from what arrives over the link; usable() from start() on.
  autonomy::StateEstimate estimate() const;
  FirmwareView view() const;
  const core::Firmware& firmware() const;
  companion::Session& session();
  sim::rc::Pilot& pilot();
  sim::FaultSchedule& faults();
  /// As Flight::set_wind() and add_gust().
  void set_wind(const sim::Vector3& steady_W_m_s, double w20_m_s);
  void add_gust(const sim::Vector3& peak_W_m_s, double duration_s);
  /// Puts the vehicle somewhere else, rotors and servos as they turn now. The firmware is not told.
  /// @returns false, and changes nothing, for a state that is not finite or below the ground.
  bool set_state(const sim::BodyState& state);
  /// The same with the states of the forces-and-moments module: rotors, servos, charge.
  bool set_state(const sim::BodyState& state, std::span<const double> module_state);
  std::span<const double> module_state() const;
  /// A fixed wing is held on the ground until its owner lets it go.
  void set_held(bool held);

  /// As RigidBody::set_external_wrench(). It is no part of a moment: restore() leaves it as it is.
  void set_external_wrench(sim::ExternalWrench* external);

  /// From now on without companion and link, which costs less: telemetry is not encoded, and commands reach the firmware by
  /// tell() alone. estimate() stands still.
  void drop_link();
  /// The firmware receives a message at once.
  void tell(const link::Message& message);
  /// Without a link: the firmware and the pilot as at `moment`, in the world as it is now, whose noise goes on.
  /// @throws Error  there is a link, or the moment is of another simulation.
  void restore_firmware(const Moment& moment);

  /// @throws Error  a job of the session is pending, or sensors or wind are a plugin's, which cannot be copied.
  std::shared_ptr<const Moment> save() const;
  /// Everything goes on as it did from there: world, instruments, firmware, link, companion, pilot, faults.
  /// @param moment  of this simulation. @throws Error  of another one, or a job of the session is pending.
  void restore(const Moment& moment);

 private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace rosflight::flight
