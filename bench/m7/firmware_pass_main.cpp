// SPDX-License-Identifier: BSD-3-Clause
// Counts the instructions of the firmware's passes on the emulated Cortex-M7, run with
// -icount shift=0: one instruction is one nanosecond, so a tick of the 25 MHz counter is 40 of
// them. Armed in hover, angle mode: an IMU sample in every pass at 400 Hz, a receiver frame at 50
// Hz, every stream on; then passes in which everything comes at once. Prints JSON.
#include <array>
#include <cstring>

#include "bench/m7/idle_board.hpp"
#include "firmware/boards/qemu_m7/registers.hpp"
#include "firmware/boards/qemu_m7/semihosting.hpp"
#include "firmware/boards/qemu_m7/startup.hpp"
#include "firmware/core/firmware.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file
namespace m7 = boards::m7;

constexpr int kPasses = 400;
constexpr int kWorstPasses = 64;
constexpr std::uint32_t kInstructionsPerTick = 40;

class Printer {
 public:
  Printer() : handle_{m7::semihosting::open(":tt", 3, 4)} {}
  void text(const char* text) const {
    while (*text != '\0') m7::semihosting::write_byte(handle_, *text++);
  }
  void number(const char* name, std::uint32_t value, const char* after) const {
    text("\"");
    text(name);
    text("\": ");
    std::array<char, 11> digits{};
    std::size_t at = digits.size() - 1;
    do {
      digits[--at] = static_cast<char>('0' + value % 10);
      value /= 10;
    } while (value != 0);
    text(&digits[at]);
    text(after);
  }

 private:
  int handle_;
};

struct Count {
  std::uint32_t passes{0};
  std::uint32_t ticks{0};
  std::uint32_t most{0};
  void add(std::uint32_t taken) {
    ++passes;
    ticks += taken;
    if (taken > most) most = taken;
  }
  std::uint32_t mean() const { return ticks * kInstructionsPerTick / passes; }
  std::uint32_t worst() const { return most * kInstructionsPerTick; }
};

class Rig {
 public:
  void bring_up() {
    firmware_.start();
    set("PRIMARY_MIXER", std::int32_t{2});
    set("FAILSAFE_THR", 0.3f);
    set("RC_ARM_CHN", std::int32_t{5});
    set("ACC_Z_BIAS", 0.01f);  // calibrated
    firmware_.handle(link::Heartbeat{}, board_.clock.now());
    constexpr int kSettle = 400;  // the vehicle has to be seen at rest
    for (int k = 0; k < kSettle; ++k) pass(0.0f, false);
    // Changed parameters are stored first, a block in each pass.
    while (!firmware_.state().armed() && passes_ < 2000) pass(0.0f, true);
    for (int k = 0; k < kSettle; ++k) pass(0.0f, true);  // motors at idle first
  }
  bool armed() const { return firmware_.state().armed(); }
  bool policy_flies() const { return firmware_.learned().flying(); }

  /// @returns ticks that the pass took.
  std::uint32_t pass(float throttle, bool arm) {
    constexpr int kPassesPerFrame = 8;
    const hal::Time now = next_time();
    const float wobble = 0.01f * static_cast<float>(passes_ % 7 - 3);
    board_.imu.put(
        {now, {0.05f + wobble, -0.03f, -9.7f + wobble}, {0.02f + wobble, -wobble, 0.01f}, 300.0f});
    if (passes_ % kPassesPerFrame == 0) put_frame(now, throttle, arm);
    return timed_run();
  }

  /// Every sensor, receiver and offboard command at once, while a parameter list runs.
  std::uint32_t full_pass() {
    const hal::Time now = next_time();
    const float wobble =
        passes_ % 2 == 0 ? 1e-3f : -1e-3f;  // equal samples would be a stuck sensor
    board_.imu.put({now, {0.05f, -0.03f, -9.7f}, {0.02f + wobble, -0.01f, 0.01f}, 300.0f});
    board_.mag.put({now, {1e-5f, 2e-5f, 4e-5f}, 300.0f});
    board_.baro.put({now, 95000.0f, 300.0f});
    board_.diff_pressure.put({now, 20.0f, 300.0f});
    board_.range.put({now, 2.0f, 0.1f, 10.0f, hal::RangeKind::kLidar});
    hal::GnssSample gnss;
    gnss.stamp = now;
    board_.gnss.put(gnss);
    board_.battery.put({now, 24.0f, 10.0f});
    put_frame(now, 0.5f, true);
    link::OffboardControl command;
    command.mode = static_cast<std::uint8_t>(link::OffboardMode::kRollPitchYawrateThrottle);
    command.u = {0.0f, 0.0f, 0.5f, 0.02f, -0.02f, 0.1f, 0.0f, 0.0f, 0.0f, 0.0f};
    send(command);
    return timed_run();
  }
  void start_list() {
    send(link::Heartbeat{});
    send(link::ParamRequestList{});
  }

 private:
  hal::Time next_time() {
    constexpr int kStep_us = 2500;
    const hal::Time now = hal::microseconds(++passes_ * kStep_us);
    board_.clock.set(now);
    return now;
  }
  void put_frame(hal::Time now, float throttle, bool arm) {
    hal::RcFrame frame;
    frame.stamp = now;
    frame.channel_count = 8;
    frame.channels = {0.52f, 0.49f, throttle, 0.5f, 0.0f, arm ? 1.0f : 0.0f, 0.0f, 0.0f};
    board_.receiver.put(frame);
  }
  std::uint32_t timed_run() {
    const std::uint32_t begin = m7::cycles();
    firmware_.run();
    return m7::cycles() - begin;
  }
  void send(const link::Message& message) {
    link::Frame frame;
    if (companion_.encode(message, frame)) board_.serial.put(frame.bytes.data(), frame.size);
  }
  template <class Value>
  void set(const char* name, Value value) {
    link::ParamSet message;
    message.name = core::padded_name(name);
    message.type = static_cast<std::uint8_t>(std::is_integral_v<Value> ? link::ParamType::kInt32
                                                                       : link::ParamType::kFloat);
    std::memcpy(&message.value.bits, &value, sizeof value);
    firmware_.handle(message, {});
  }

  bench::IdleBoard board_;
  link::MavlinkCodec codec_{{1, link::MavlinkCodec::kFcuComponent}, link::mavlink::fcu_messages()};
  link::MavlinkCodec companion_{{1, link::MavlinkCodec::kCompanionComponent}};
  core::Firmware firmware_{board_.roles(), codec_};
  std::int32_t passes_{0};
};

}  // namespace

/// For a trace of the processor: the passes between these two calls are the ones that count.
extern "C" __attribute__((noinline)) void bench_mean_begins() {
  asm volatile("");
}
extern "C" __attribute__((noinline)) void bench_mean_ends() {
  asm volatile("");
}

int board_main() {
  static Rig rig;
  rig.bring_up();
  if (!rig.armed()) {
    m7::semihosting::print("firmware_pass: the firmware did not arm\n");
    return 1;
  }
  Count mean;
  bench_mean_begins();
  for (int k = 0; k < kPasses; ++k) mean.add(rig.pass(0.5f, true));
  bench_mean_ends();
  Count full;
  rig.start_list();
  for (int k = 0; k < kWorstPasses; ++k) full.add(rig.full_pass());
  const Printer out;
  out.text("{");
  out.number("passes", mean.passes, ", ");
  out.number("instructions", mean.mean(), ", ");
  out.number("instructions_most", mean.worst(), ", ");
  out.number("instructions_full", full.mean(), ", ");
  out.number("instructions_worst", full.worst(), ", ");
  out.number("object_bytes", sizeof(core::Firmware) + sizeof(link::MavlinkCodec), ", ");
  out.number("policy_bytes", sizeof(core::LearnedController), ", ");
  out.number("policy_flies", rig.policy_flies() ? 1 : 0, ", ");
  out.number("stack_bytes", m7::stack_high_water(), "}\n");
  return rig.armed() ? 0 : 1;
}
