// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/debug_unit.hpp"

#include "firmware/boards/stm32h7/emulator/test/models_rig.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

class Debug : public Models {
 protected:
  Debug() { unit.reset(); }
  DebugUnit unit{core};
};

TEST_F(Debug, ShowsDeviceAndRevision) {
  EXPECT_EQ(read(unit, dbgmcu::IDC), 0x2003'0450U);
  unit.set_revision(DebugUnit::Revision::kY);
  EXPECT_EQ(read(unit, dbgmcu::IDC), 0x2003'0450U) << "up to the next reset";
  unit.reset();
  EXPECT_EQ(read(unit, dbgmcu::IDC), 0x1003'0450U);
  write(unit, dbgmcu::IDC, 0);
  EXPECT_EQ(core.complaints.size(), 1U);
}

TEST_F(Debug, StopsWhatItsBitsName) {
  const Instance* const all[] = {&TIM1, &TIM2, &TIM3, &TIM4,  &TIM5,
                                 &TIM6, &TIM7, &TIM8, &TIM12, &IWDG1};
  for (const Instance* each : all) EXPECT_FALSE(unit.stops(*each));
  write(unit, dbgmcu::APB2FZ1, 1U << 0U);
  write(unit, dbgmcu::APB1LFZ1, 1U << 5U | 1U << 6U);
  write(unit, dbgmcu::APB4FZ1, 1U << 18U);
  for (const Instance* each : all) {
    const bool stopped = *each == TIM1 || *each == TIM7 || *each == TIM12 || *each == IWDG1;
    EXPECT_EQ(unit.stops(*each), stopped) << std::hex << each->base;
  }
  EXPECT_FALSE(unit.stops(SPI1)) << "it has no such bit";
}

TEST_F(Debug, OneReadAtATimeIsABitOfTheMatrix) {
  AxiMatrix matrix{core};
  EXPECT_FALSE(matrix.reads_one_at_a_time());
  write(matrix, axi::TARG7_FN_MOD, 1);
  EXPECT_TRUE(matrix.reads_one_at_a_time());
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
