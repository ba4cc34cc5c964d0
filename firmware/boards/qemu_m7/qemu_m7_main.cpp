// SPDX-License-Identifier: BSD-3-Clause
// The image: board, link and firmware put together, in lock-step with the world or in real time.
#include "firmware/boards/common/glance_main.hpp"
#include "firmware/boards/common/object_storage.hpp"
#include "firmware/boards/qemu_m7/block_serial.hpp"
#include "firmware/boards/qemu_m7/qemu_board.hpp"
#include "firmware/boards/qemu_m7/semihosting.hpp"
#include "firmware/boards/qemu_m7/startup.hpp"
#include "firmware/boards/qemu_m7/uart.hpp"
#include "firmware/core/firmware.hpp"
#include ROSFLIGHT_IMAGE_LINK

namespace {

using namespace rosflight;              // NOLINT(google-build-using-namespace): this is their main
using namespace rosflight::boards::m7;  // NOLINT(google-build-using-namespace)

struct Autopilot {
  explicit Autopilot(const hal::Board& board) : firmware{board, link.codec} {}
  boards::ImageLink link;
  core::Firmware firmware;
};

// One of each in an image; the interrupt handlers at the end must find them. All zero at start.
boards::ObjectStorage<Autopilot> autopilot_storage;
boards::ObjectStorage<HardwareClock> hardware_clock_storage;
boards::ObjectStorage<Uart> uart_storage;
boards::ObjectStorage<QemuBoard> board_storage;
boards::ObjectStorage<ToProcessor> inputs_storage;

/// The two ends of the lock-step's pipes.
class Doorbell {
 public:
  Doorbell()
      : in_{semihosting::open(kToProcessorPipe, sizeof kToProcessorPipe - 1, 1)},
        out_{semihosting::open(kFromProcessorPipe, sizeof kFromProcessorPipe - 1, 5)} {
    if (in_ < 0 || out_ < 0) {
      semihosting::print("qemu_m7: no pipes to the world\n");
      semihosting::exit(1);
    }
  }
  void ring(Bell what) const { semihosting::write_byte(out_, static_cast<char>(what)); }
  /// Stands still until the world rings; when it never will again, this is the end.
  void wait() const {
    char byte = 0;
    if (!semihosting::read_byte(in_, byte)) semihosting::exit(0);
    memory_barrier();
  }

 private:
  int in_;
  int out_;
};

[[noreturn]] void run_in_lock_step(ExchangeBlock& block) {
  const Doorbell bell;
  LatchedClock clock;
  BlockSerial serial(block);
  QemuBoard& board = board_storage.make(Coupling::kLockStep);
  core::Firmware& firmware = autopilot_storage.make(board.roles(clock, serial)).firmware;
  bell.ring(Bell::kBooted);
  for (;;) {
    bell.wait();
    const ToProcessor& in = block.to_processor;
    FromProcessor& out = block.from_processor;
    // The watchdog watches passes; waiting for the world is no hang.
    Watchdog::start(QemuBoard::kWatchdogLockStep_ms);
    const std::uint32_t begin = cycles();
    out.passes = 0;
    clock.set(hal::Time{in.time_us});
    serial.begin();
    if (in.order == Order::kStart) {
      firmware.start();
    } else if (in.order == Order::kStep) {
      board.imu.expect(in.trouble);
      board.take_receiver(in, hal::Time{0});
      if (in.has_rc != 0 || serial.waiting()) {
        firmware.run();
        ++out.passes;
      }
      board.take_sensors(in, hal::Time{0});
      firmware.run();
      ++out.passes;
      if (boards::aids_waiting(board)) {
        firmware.run();
        ++out.passes;
      }
    }
    out.ticks = cycles() - begin;
    Watchdog::stop();
    board.report(out);
    boards::glance(firmware, out.firmware);
    ++out.sequence;
    memory_barrier();
    bell.ring(Bell::kDone);
    if (board.system.reset_requested()) reset_processor();
  }
}

/// Copies what the world wrote, once it is whole. @returns false if it is being written.
bool read_block(const ExchangeBlock& block, ToProcessor& copy) {
  const volatile std::uint32_t& sequence = block.to_processor.sequence;
  const std::uint32_t before = sequence;
  if ((before & 1u) != 0) return false;  // odd: the world is writing
  memory_barrier();
  copy = block.to_processor;
  memory_barrier();
  return sequence == before;
}

/// From the world's clock to the board's. A block waits until the board looks, so the shortest wait
/// is the measure of the offset; it may grow again slowly, and at once after a pause of the host.
class WorldLag {
 public:
  hal::Time update(hal::Time now) {
    constexpr hal::Time kPause = hal::milliseconds(50);
    constexpr int kSlowly = 1024;
    const bool jumped = now > lag_ + kPause;
    lag_ = !known_ || jumped || now < lag_ ? now : lag_ + (now - lag_) / kSlowly;
    known_ = true;
    return lag_;
  }

 private:
  hal::Time lag_{};
  bool known_{false};
};

void report_uart(const Uart& uart, FromProcessor& out) {
  out.uart_received = uart.counters().received;
  out.uart_sent = uart.counters().sent;
  out.uart_overruns = uart.counters().overruns;
  out.uart_frames_dropped = uart.frames_dropped();
}

[[noreturn]] void run_in_real_time(ExchangeBlock& block) {
  constexpr std::uint32_t kTick_Hz = 1000;
  ToProcessor& in = inputs_storage.make();
  HardwareClock& clock = hardware_clock_storage.make();
  Uart& uart = uart_storage.make(Uart::kUart0);
  QemuBoard& board = board_storage.make(Coupling::kRealTime);
  core::Firmware& firmware = autopilot_storage.make(board.roles(clock, uart)).firmware;
  start_tick(kTick_Hz);
  asm volatile("cpsie i" ::: "memory");
  firmware.start();
  Watchdog::start(QemuBoard::kWatchdogRealTime_ms);
  FromProcessor& out = block.from_processor;
  std::uint32_t seen = 0;
  WorldLag lag;
  for (;;) {
    const volatile std::uint32_t& sequence = block.to_processor.sequence;
    if (sequence != seen && read_block(block, in)) {
      seen = in.sequence;
      const hal::Time offset = lag.update(clock.now() - hal::Time{in.time_us});
      board.imu.expect(in.trouble);
      board.take_receiver(in, offset);
      board.take_sensors(in, offset);
    } else if (!uart.waiting()) {
      wait_for_interrupt();
    }
    firmware.run();
    ++out.sequence;  // odd: being written
    memory_barrier();
    ++out.passes;
    board.report(out);
    report_uart(uart, out);
    boards::glance(firmware, out.firmware);
    memory_barrier();
    ++out.sequence;
    if (board.system.reset_requested()) reset_processor();
  }
}

}  // namespace

extern "C" {

void board_fault(const FaultRegisters& registers) {
  if (board_storage.get() != nullptr) board_storage.get()->outputs.disable();
  if (autopilot_storage.get() != nullptr) autopilot_storage.get()->firmware.record_fault(registers);
}

void board_tick() {
  if (hardware_clock_storage.get() != nullptr) hardware_clock_storage.get()->keep();
}

void board_uart0_receive() {
  uart_storage.get()->on_receive();
}
void board_uart0_transmit() {
  uart_storage.get()->on_transmit();
}

int board_main() {
  ExchangeBlock& block = exchange_block();
  if (block.to_processor.coupling == Coupling::kRealTime) run_in_real_time(block);
  run_in_lock_step(block);
}
}
