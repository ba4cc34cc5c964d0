// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "autonomy/multirotor/test/flight.hpp"
#include "test_support/allocations.hpp"

namespace rosflight::autonomy::multirotor::test {
namespace {

TEST(Allocation, AWholeFlightAllocatesNothing) {
  Flight world;
  FlightManager manager(default_config(), world.mission);
  Plant plant({}, default_config().thrust);
  ASSERT_GT(test_support::allocations(), 0U);  // the counter counts
  const std::size_t before = test_support::allocations();
  bool landed = false;
  for (int k = 0; k < 80000 && !landed; ++k) {
    if (k % 5 == 0)
      landed = manager.step({k * 1e-3, plant.state(), {.armed = true}}).request_disarm;
    plant.step(manager.output().command, true, 1e-3);
  }
  EXPECT_TRUE(landed);
  EXPECT_EQ(test_support::allocations(), before);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor::test
