// SPDX-License-Identifier: BSD-3-Clause
#include "companion/offboard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "companion/test/rig.hpp"

namespace rosflight::companion::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::vector<link::OffboardControl> offboards(const FakeFcu& fcu) {
  std::vector<link::OffboardControl> all;
  for (const link::Message& m : fcu.received) {
    if (const auto* command = std::get_if<link::OffboardControl>(&m)) {
      all.push_back(*command);
    }
  }
  return all;
}

// Sample frame of the ROSflight 2.x protocol: mode 2, ignore 0x3C3, u = (0, 0, 0.5, 0.1, -0.2, 0.3,
// 0, ...).
TEST(Offboard, AngleSetPointIsTheDocumentedOne) {
  const link::OffboardControl command = angles(0.1f, -0.2f, 0.3f, 0.5f);
  EXPECT_EQ(command.mode, 2);
  EXPECT_EQ(command.ignore, 0x3C3);
  EXPECT_EQ(command.u, (std::array<float, 10>{0, 0, 0.5f, 0.1f, -0.2f, 0.3f, 0, 0, 0, 0}));
}

TEST(Offboard, BuildersFillModeAxisAndMask) {
  const auto rates = body_rates(1.0f, 2.0f, 3.0f, 0.6f, ThrottleAxis::kX);
  EXPECT_EQ(rates.mode, 1);
  EXPECT_EQ(rates.ignore, 0x3C6);  // 1, 2 and the free four
  EXPECT_EQ(rates.u, (std::array<float, 10>{0.6f, 0, 0, 1, 2, 3, 0, 0, 0, 0}));
  const auto fixedwing = surfaces(0.1f, 0.2f, 0.3f, 0.4f);
  EXPECT_EQ(fixedwing.mode, 0);
  EXPECT_EQ(fixedwing.u, (std::array<float, 10>{0.4f, 0, 0, 0.1f, 0.2f, 0.3f, 0, 0, 0, 0}));
  const auto all = pass_through({0, 0, -9, 1, 2, 3, 4, 5, 6, 7}, ignore_bit(0) | ignore_bit(9));
  EXPECT_EQ(all.mode, 0);
  EXPECT_EQ(all.ignore, 0x201);
}

TEST(Offboard, NothingWrongReachesTheLink) {
  Rig rig;
  rig.step();
  Offboard& offboard = rig.session.offboard();
  auto bad = angles(0.0f, 0.0f, 0.0f, 0.5f);
  bad.u[3] = kNaN;
  EXPECT_EQ(offboard.send(bad), SendStatus::kNotFinite);
  bad = angles(0.0f, 0.0f, 0.0f, 0.5f);
  bad.u[9] = std::numeric_limits<float>::infinity();  // ignored entries travel too
  EXPECT_EQ(offboard.send(bad), SendStatus::kNotFinite);
  bad = angles(0.0f, 0.0f, 0.0f, 0.5f);
  bad.mode = 3;
  EXPECT_EQ(offboard.send(bad), SendStatus::kBadMode);
  bad = angles(0.0f, 0.0f, 0.0f, 0.5f);
  bad.ignore = 0x400;
  EXPECT_EQ(offboard.send(bad), SendStatus::kBadMode);
  EXPECT_EQ(offboard.hold(angles(kNaN, 0, 0, 0), 100.0, 1s), SendStatus::kNotFinite);
  EXPECT_EQ(offboard.hold(angles(0, 0, 0, 0), 0.0, 1s), SendStatus::kBadMode);
  EXPECT_EQ(offboard.hold(angles(0, 0, 0, 0), std::nan(""), 1s), SendStatus::kBadMode);

  link::AuxCommand aux;
  aux.type[0] = 3;
  EXPECT_EQ(offboard.send(aux), SendStatus::kBadMode);
  aux.type[0] = 2;
  aux.value[0] = -0.1f;
  EXPECT_EQ(offboard.send(aux), SendStatus::kBadMode);
  aux.type[0] = 1;
  aux.value[0] = kNaN;
  EXPECT_EQ(offboard.send(aux), SendStatus::kNotFinite);
  EXPECT_EQ(offboard.send(link::ExternalAttitude{{0, 0, 0, 0}}), SendStatus::kBadMode);
  EXPECT_EQ(offboard.send(link::ExternalAttitude{{1, kNaN, 0, 0}}), SendStatus::kNotFinite);
  rig.run_for(100ms);
  EXPECT_EQ(offboards(rig.fcu).size(), 0U);
  EXPECT_EQ(rig.fcu.count_received<link::AuxCommand>(), 0U);
  EXPECT_EQ(rig.fcu.count_received<link::ExternalAttitude>(), 0U);
  EXPECT_EQ(offboard.counters().refused, 12U);
}

TEST(Offboard, GoodOnesArriveUnchangedAndAttitudesNormalised) {
  Rig rig;
  rig.step();
  EXPECT_EQ(rig.session.offboard().send(angles(0.1f, -0.2f, 0.3f, 0.5f)), SendStatus::kSent);
  link::AuxCommand aux;
  aux.type = {1, 2};
  aux.value = {-1.0f, 1.0f};
  EXPECT_EQ(rig.session.offboard().send(aux), SendStatus::kSent);
  EXPECT_EQ(rig.session.offboard().send(link::ExternalAttitude{{0, 0, 0, -2}}), SendStatus::kSent);
  rig.step();
  ASSERT_EQ(offboards(rig.fcu).size(), 1U);
  EXPECT_EQ(offboards(rig.fcu)[0].u, angles(0.1f, -0.2f, 0.3f, 0.5f).u);
  for (const link::Message& m : rig.fcu.received) {
    if (const auto* attitude = std::get_if<link::ExternalAttitude>(&m)) {
      EXPECT_EQ(attitude->q_WB, (std::array<float, 4>{0, 0, 0, -1}));
    }
    if (const auto* command = std::get_if<link::AuxCommand>(&m)) {
      EXPECT_EQ(command->value, aux.value);
    }
  }
}

TEST(Offboard, HoldRepeatsAtItsRateUntilItsLifeIsOver) {
  Rig rig;
  rig.step();
  ASSERT_EQ(rig.session.offboard().hold(angles(0, 0, 0, 0.5f), 100.0, 1s), SendStatus::kSent);
  rig.run_for(3s);
  EXPECT_NEAR(static_cast<double>(offboards(rig.fcu).size()), 100.0, 1.0);
  EXPECT_FALSE(rig.session.offboard().holding());
}

TEST(Offboard, ReleaseEndsAHold) {
  Rig rig;
  rig.step();
  ASSERT_EQ(rig.session.offboard().hold(angles(0, 0, 0, 0.5f), 50.0, 10s), SendStatus::kSent);
  rig.run_for(200ms);
  rig.session.offboard().release();
  rig.step();  // one may be in the cable
  const std::size_t sent = offboards(rig.fcu).size();
  EXPECT_NEAR(static_cast<double>(sent), 11.0, 1.0);
  rig.run_for(1s);
  EXPECT_EQ(offboards(rig.fcu).size(), sent);
}

TEST(Offboard, AClosedLinkIsSaid) {
  Rig rig;
  rig.step();
  rig.link.plug(false);
  rig.step();
  EXPECT_EQ(rig.session.offboard().send(angles(0, 0, 0, 0.5f)), SendStatus::kLinkBusy);
  EXPECT_EQ(rig.session.offboard().counters().dropped, 1U);
}

}  // namespace
}  // namespace rosflight::companion::test
