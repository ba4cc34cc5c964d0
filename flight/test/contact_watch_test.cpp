// SPDX-License-Identifier: BSD-3-Clause
#include "flight/contact_watch.hpp"

#include <gtest/gtest.h>

namespace rosflight::flight {
namespace {

using Contact = sim::PhysicsEngine::Contact;

Contact touching(double approach_m_s, double normal_up = 1.0, bool airframe = false) {
  Contact contact;
  contact.touches = true;
  contact.airframe = airframe;
  contact.approach_m_s = approach_m_s;
  contact.normal_up = normal_up;
  contact.other = "field";
  return contact;
}

/// What is said of a contact one second after the vehicle stood.
std::optional<ContactWatch::Event> after_flight(const Contact& contact) {
  ContactWatch watch;
  EXPECT_FALSE(watch.step(sim::Time{0}, touching(0.0)));  // it stands, which is no event
  EXPECT_FALSE(watch.step(sim::Time{500'000}, {}));
  return watch.step(sim::Time{1'000'000}, contact);
}

TEST(ContactWatch, ALandingIsAnEvent) {
  const auto event = after_flight(touching(0.35));
  ASSERT_TRUE(event);
  EXPECT_FALSE(event->crash);
  EXPECT_EQ(event->text, "touches field at 0.35 m/s");
}

TEST(ContactWatch, TellsCrashesFromContacts) {
  EXPECT_FALSE(after_flight(touching(3.99))->crash);
  EXPECT_TRUE(after_flight(touching(4.01))->crash);
  EXPECT_TRUE(after_flight(touching(1.01, 0.49))->crash);   // a wall
  EXPECT_FALSE(after_flight(touching(0.99, 0.49))->crash);  // leaning on it
  EXPECT_TRUE(after_flight(touching(1.01, -1.0))->crash);   // a roof from below
  EXPECT_TRUE(after_flight(touching(0.0, 1.0, true))->crash);
  EXPECT_EQ(after_flight(touching(4.01))->text, "hit field at 4.01 m/s");
}

TEST(ContactWatch, ReboundsAndASecondCrashAreNoEvents) {
  ContactWatch watch;
  EXPECT_FALSE(watch.step(sim::Time{0}, touching(0.0)));
  ASSERT_TRUE(watch.step(sim::Time{1'000'000}, touching(2.0)));
  EXPECT_FALSE(watch.step(sim::Time{1'400'000}, touching(1.0)));
  EXPECT_TRUE(watch.step(sim::Time{1'402'500}, touching(5.0))->crash);  // however soon
  EXPECT_FALSE(watch.step(sim::Time{1'405'000}, touching(5.0)));
}

}  // namespace
}  // namespace rosflight::flight
