// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "sim/dynamics/physics_engine.hpp"

namespace rosflight::flight {

/// Contacts with a world of a physics engine, as events.
///
/// A crash is: body, wing or a propeller touches; the gear touches faster than kCrashSpeed_m_s of landings; or faster than
/// kSide_m_s a surface that is steeper than 60 degrees, which no gear is made for. The first one counts.
class ContactWatch {
 public:
  static constexpr double kSide_m_s = 1.0;
  /// A contact after so long in the air is an event; rebounds before belong to the last.
  static constexpr sim::Time kApart{500'000};

  struct Event {
    bool crash{false};
    std::string text;  ///< Such as "touches field at 0.35 m/s" or "hit house at 3.10 m/s".
  };

  /// Once per step. @param t  time of the contact.
  std::optional<Event> step(sim::Time t, const sim::PhysicsEngine::Contact& contact);

 private:
  std::optional<sim::Time> last_;  ///< Last contact.
  bool crashed_{false};
};

}  // namespace rosflight::flight
