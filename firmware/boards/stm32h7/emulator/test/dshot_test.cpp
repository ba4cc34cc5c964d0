// SPDX-License-Identifier: BSD-3-Clause
// Bursts of DMA at each update of a timer, and the DShot frames that come out of its pins.
#include <cstring>

#include "firmware/boards/parts/pulses.hpp"
#include "firmware/boards/stm32h7/emulator/test/models_rig.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

constexpr std::uint32_t kBurst = 4, kTimer_hz = 200'000'000;

class Dshot : public Models {
 protected:
  Dshot() {
    start_clocks();
    tim.reset();
    dma1.on_start = [this](std::uint32_t request) { tim.stream_started(request); };
  }
  void start(std::uint32_t period) {
    write(tim, tim::ARR, period - 1);
    write(tim, tim::CCMR1, tim::CCMR1_OC1M(6) | tim::CCMR1_OC1PE(1));
    write(tim, tim::CCER, 1);
    write(tim, tim::BDTR, tim::BDTR_MOE(1));
    write(tim, tim::DCR, tim::DCR_DBA(tim::CCR1 / 4) | tim::DCR_DBL(kBurst - 1));
    write(tim, tim::EGR, 1);
    write(tim, tim::DIER, tim::DIER_UDE(1));
    write(tim, tim::CR1, tim::CR1_ARPE(1) | tim::CR1_CEN(1));
  }
  void send(const std::array<std::uint16_t, parts::kDshotCounts>& counts, std::size_t bits) {
    std::array<std::uint16_t, kBurst * parts::kDshotCounts> burst{};
    for (std::size_t k = 0; k < bits; ++k) burst[kBurst * k] = counts[k];
    std::memcpy(core.bytes.data(), burst.data(), sizeof burst);
    write(dma1, dma::LIFCR, 0x3D);
    write(multiplexer, 0, request::TIM1_UP);
    write(dma1, 0x10U + dma_stream::NDTR, static_cast<std::uint32_t>(burst.size()));
    write(dma1, 0x10U + dma_stream::PAR, TIM1.base + tim::DMAR);
    write(dma1, 0x10U + dma_stream::M0AR, FakeCore::kMemory);
    write(dma1, 0x10U + dma_stream::CR,
          dma_stream::CR_EN(1) | dma_stream::CR_DIR(1) | dma_stream::CR_MINC(1) |
              dma_stream::CR_PSIZE(1) | dma_stream::CR_MSIZE(1));
  }
  TimerModel tim{core,      "TIM1",          TIM1,
                 clocks,    irq::TIM1_UP,    TimerModel::Kind::kAdvanced,
                 &requests, request::TIM1_UP};
};

TEST_F(Dshot, FramesOfEveryRateComeOutAsTheyWereMade) {
  for (const float rate : {150'000.0F, 300'000.0F, 600'000.0F, 1'200'000.0F}) {
    const parts::PulsePlan plan = parts::plan_pulses(&rate, 1, kTimer_hz);
    write(tim, tim::CR1, 0);
    start(plan.period);
    for (const std::uint32_t throttle : {0U, 48U, 1047U, 2047U}) {
      const std::uint16_t frame = parts::dshot_frame(static_cast<std::uint16_t>(throttle), false);
      send(parts::dshot_counts(frame, plan.period), parts::kDshotCounts);
      core.run_for(20 * plan.period * kTicksPerSecond / kTimer_hz);
      EXPECT_EQ(tim.dshot_throttle(0), throttle) << rate;
      EXPECT_EQ(tim.pulse(0), 0U) << "low between frames";
    }
  }
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
}

TEST_F(Dshot, BurstsLeaveAForcedLevelAlone) {
  start(667);
  write(tim, tim::CCMR1, tim::CCMR1_OC1M(5) | tim::CCMR1_OC1PE(1));
  send(parts::dshot_counts(parts::dshot_frame(1000, false), 667), 12);
  core.run_for(100 * kTicksPerMicrosecond);
  EXPECT_TRUE(tim.forced_high(0));
  EXPECT_EQ(tim.dshot_throttle(0), 0U) << "it makes no bits, so 12 of them are no train";
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
}

TEST_F(Dshot, WhatNoSpeedControllerTakesIsComplainedOf) {
  start(667);
  send(parts::dshot_counts(parts::dshot_frame(1000, false), 667), 12);
  core.run_for(100 * kTicksPerMicrosecond);
  expect_complaint("a train of 12 bits");
  send(parts::dshot_counts(static_cast<std::uint16_t>(parts::dshot_frame(1000, false) ^ 1U), 667),
       parts::kDshotCounts);
  core.run_for(100 * kTicksPerMicrosecond);
  expect_complaint("wrong checksum");
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
