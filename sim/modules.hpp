// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>

#include "sim/types.hpp"

/// The seven exchangeable modules of the simulation. Each is a plain object; the same objects are
/// wired in lock-step (sim/lock_step.hpp) and, one per process, as ROS 2 nodes. None of them reads a
/// wall clock or a global variable.
namespace rosflight::sim {

/// 1. Time: the length of each step, and the pace of the steps.
class TimeSource {
 public:
  virtual ~TimeSource() = default;
  /// Ends the step that started at `now` and returns the start of the next; sleeps if the source has
  /// a pace.
  virtual Time advance(Time now) = 0;
};

/// 2. Autopilot: flight control hardware with the real firmware, the system under test.
class AutopilotModule {
 public:
  virtual ~AutopilotModule() = default;
  /// One step at time t: passes samples and bytes to the firmware, runs it and returns the 14 outputs
  /// (0..1).
  /// @param rc  a receiver frame, or nullptr if none was received in this step.
  virtual const hal::OutputValues& step(Time t, const SensorSamples& samples,
                                        const hal::RcFrame* rc) = 0;
};

/// 3. RC: the pilot with a transmitter (script, joystick, keyboard, ROS).
class RcModule {
 public:
  virtual ~RcModule() = default;
  /// @returns true if a frame was received at t; `frame` is then filled, flags included.
  virtual bool step(Time t, hal::RcFrame& frame) = 0;
};

/// 4. Sensors: measurements from truth.
class SensorsModule {
 public:
  virtual ~SensorsModule() = default;
  /// Samples that become available at truth.time; stamps are times of measurement.
  virtual void step(const Truth& truth, SensorSamples& samples) = 0;
};

/// 5. Forces and moments: actuators, propulsion, aerodynamics. Its own continuous states (rotor
/// speeds, servo angles, battery charge) are integrated together with the rigid body, by the same
/// scheme.
class ForcesAndMoments {
 public:
  /// Maximum number of states of a module.
  static constexpr std::size_t kMaxStates = 32;

  struct Input {
    const BodyState& body;
    const Matrix3& R_WB;     ///< Computed from body.q_WB.
    const Vector3& v_air_B;  ///< Velocity through the air: body.v_B less the wind [m/s].
    const Air& air;
    const hal::OutputValues& outputs;  ///< Held constant over a step; may be NaN.
    double height_above_ground_m;      ///< Height of the centre of mass.
  };

  virtual ~ForcesAndMoments() = default;
  virtual std::size_t state_size() const = 0;
  /// Fills the state_size() states of a vehicle at rest with stopped rotors.
  virtual void initial_state(std::span<double> x) const = 0;
  /// Computes the wrench without gravity and ground contact, and dx/dt. Called four times per step: no
  /// side effects, no heap.
  virtual void evaluate(const Input& in, std::span<const double> x, Wrench& wrench,
                        std::span<double> x_dot) const = 0;
  /// Keeps states physical after a step (rotor speed >= 0, charge >= 0). Default: nothing.
  virtual void limit_state(std::span<double> x) const { static_cast<void>(x); }
  /// Fills rotor speeds and battery terminals of `truth` from the states. Default: nothing.
  virtual void report(const Input& in, std::span<const double> x, Truth& truth) const {
    static_cast<void>(in), static_cast<void>(x), static_cast<void>(truth);
  }
  /// Injects a fault, in force until the next call: the rotor has `factor` (0..1) of its thrust; 0 is a
  /// dead motor. Default: nothing, for modules without rotors.
  virtual void set_thrust_factor(std::size_t rotor, double factor) {
    static_cast<void>(rotor), static_cast<void>(factor);
  }
  /// The same: a control surface keeps its deflection. Default: nothing, for modules without.
  virtual void set_surface_stuck(std::size_t surface, bool stuck) {
    static_cast<void>(surface), static_cast<void>(stuck);
  }
  /// The same: no more than this share of the battery's charge is left; 1: all. Default: nothing.
  virtual void set_charge_limit(double share) { static_cast<void>(share); }
};

/// Changes the wrench of the vehicle's own module from outside: a tether, a model on trial.
class ExternalWrench {
 public:
  virtual ~ExternalWrench() = default;
  /// Called behind every ForcesAndMoments::evaluate(), with its input.
  /// @param wrench  what the module computed: to be added to, or replaced.
  virtual void change(const ForcesAndMoments::Input& in, Wrench& wrench) = 0;
};

/// 6. Dynamics: moves the body under wrench, gravity and ground; owns wind and air.
class Dynamics {
 public:
  virtual ~Dynamics() = default;
  /// Advances from truth().time to t with the outputs held.
  virtual void step(Time t, const hal::OutputValues& outputs) = 0;
  virtual const Truth& truth() const = 0;
  /// Sets the state, with actuators at rest; the quaternion is normalised. @returns false and changes
  /// nothing for a state with a NaN, a zero quaternion or a position below the ground.
  virtual bool set_state(const BodyState& state) = 0;
};

/// 7. Visualiser: receives the truth and changes nothing (log, RViz, web).
class Visualiser {
 public:
  virtual ~Visualiser() = default;
  /// Called after every step with the new truth and the outputs that led to it.
  virtual void step(const Truth& truth, const hal::OutputValues& outputs) = 0;
};

}  // namespace rosflight::sim
