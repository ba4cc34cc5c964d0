// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/qemu_m7/test/crossed_uarts.hpp"

#include "firmware/boards/qemu_m7/startup.hpp"

namespace rosflight::boards::m7 {
namespace {

// For the interrupt handlers below.
CrossedUarts* pair = nullptr;
bool holding = false;

/// Waits for what the emulator does in real time. @returns false after five seconds.
template <class Condition>
bool wait_for(Condition condition) {
  constexpr std::uint32_t kMaxCycles = 5u * kClock_Hz;
  const std::uint32_t begin = cycles();
  while (!condition()) {
    if (cycles() - begin > kMaxCycles) return false;
    // Reading registers without pause would keep the emulator from its sockets.
    wait_for_interrupt();
  }
  return true;
}

}  // namespace

CrossedUarts::CrossedUarts() {
  // The emulator looks whether a UART takes bytes when its main loop turns; a timer turns it.
  constexpr std::uint32_t kTick_Hz = 1000;
  start_tick(kTick_Hz);
  pair = this;
  holding = true;
  far.open(921'600, 0);
}

CrossedUarts::~CrossedUarts() {
  for (const unsigned irq : {0u, 1u, 2u, 3u}) disable_interrupt(irq);
  pair = nullptr;
}

void CrossedUarts::deliver(const std::vector<std::uint8_t>& bytes) {
  const std::uint32_t wanted = near.counters().received + static_cast<std::uint32_t>(bytes.size());
  ASSERT_TRUE(far.write(bytes.data(), bytes.size(), hal::Serial::kOrdinary));
  EXPECT_TRUE(wait_for([&] { return near.counters().received == wanted; }));
}

std::vector<std::uint8_t> CrossedUarts::sent() {
  holding = false;
  pend_interrupt(Uart::kUart0.transmit_irq);
  EXPECT_TRUE(wait_for([&] { return near.idle(); }));
  EXPECT_TRUE(wait_for([&] { return far.counters().received == near.counters().sent; }));
  holding = true;
  std::vector<std::uint8_t> bytes(16384);
  bytes.resize(far.read(bytes.data(), bytes.size()));
  return bytes;
}

}  // namespace rosflight::boards::m7

extern "C" {
using rosflight::boards::m7::holding;
using rosflight::boards::m7::pair;
void board_uart0_receive() {
  pair->near.on_receive();
}
void board_uart0_transmit() {
  if (!holding) pair->near.on_transmit();
}
void board_uart1_receive() {
  pair->far.on_receive();
}
void board_uart1_transmit() {
  pair->far.on_transmit();
}
}
