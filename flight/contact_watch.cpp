// SPDX-License-Identifier: BSD-3-Clause
#include "flight/contact_watch.hpp"

#include <fmt/format.h>

#include "flight/landing_score.hpp"

namespace rosflight::flight {

std::optional<ContactWatch::Event> ContactWatch::step(sim::Time t,
                                                      const sim::PhysicsEngine::Contact& contact) {
  if (!contact.touches) return std::nullopt;
  const bool begins = last_ && t - *last_ > kApart;
  last_ = t;
  const bool steep = contact.normal_up < sim::PhysicsEngine::kSteep;
  const bool crash = contact.airframe ||
                     contact.approach_m_s > (steep ? kSide_m_s : LandingScore::kCrashSpeed_m_s);
  if (crash && !crashed_) {
    crashed_ = true;
    return Event{true, fmt::format("hit {} at {:.2f} m/s", contact.other, contact.approach_m_s)};
  }
  if (!begins) return std::nullopt;
  return Event{false, fmt::format("touches {} at {:.2f} m/s", contact.other, contact.approach_m_s)};
}

}  // namespace rosflight::flight
