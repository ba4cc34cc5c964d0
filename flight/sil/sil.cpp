// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/sil.hpp"

#include <fmt/format.h>
#include <sys/prctl.h>

#include <iostream>

#include "flight/link_protocol.hpp"
#include "flight/sil/linux_autopilot.hpp"
#include "flight/sil/pace.hpp"
#include "flight/sil/signals.hpp"
#include "flight/sil/world.hpp"
#include "sim/lock_step.hpp"
#include "sim/time_sources.hpp"

namespace rosflight::flight {
namespace {

using boards::LinuxClock;

base::LinkAddress read_link(const SilOptions& options) {
  auto address = base::parse_board_link(options.link);
  if (options.listen) {
    if (address.kind != base::LinkAddress::Kind::kUdp) {
      throw config::Error(
          fmt::format("--listen: found link '{}', allowed with udp:HOST:PORT only", options.link));
    }
    address.local_port = *options.listen;
  }
  return address;
}

sim::Time step_of(const SilOptions& options) {
  if (options.rate_Hz < SilOptions::kMinRate_Hz || options.rate_Hz > SilOptions::kMaxRate_Hz) {
    throw config::Error(fmt::format("--rate: found {}, allowed {} to {} Hz", options.rate_Hz,
                                    SilOptions::kMinRate_Hz, SilOptions::kMaxRate_Hz));
  }
  constexpr int kMicroseconds = 1'000'000;
  return sim::Time{(kMicroseconds + options.rate_Hz / 2) / options.rate_Hz};
}

/// Answers the link until the next tick.
class Waiter {
 public:
  Waiter(boards::LinuxSerial& serial, LinuxAutopilot& autopilot, Signals& signals)
      : serial_{serial}, autopilot_{autopilot}, signals_{signals} {
    // Without this, the kernel may wake us 50 us late to save power.
    ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  }

  /// @returns false if the program shall end.
  bool wait_until(hal::Time tick) {
    do {
      set_.assign(1, {signals_.fd(), POLLIN, 0});
      serial_.add_to(set_);
      const hal::Time left = serial_.more() ? hal::Time{0} : tick - LinuxClock::steady();
      if (poll_for(left) <= 0 && !serial_.more()) continue;
      if (signals_.take()) return false;
      autopilot_.link_pass();
    } while (LinuxClock::steady() < tick);
    return true;
  }

 private:
  int poll_for(hal::Time time) {
    constexpr std::int64_t kMicroseconds = 1'000'000;
    constexpr std::int64_t kNanoseconds = 1000;
    const std::int64_t us = std::max<std::int64_t>(time.count(), 0);
    const timespec timeout{us / kMicroseconds, us % kMicroseconds * kNanoseconds};
    return ::ppoll(set_.data(), set_.size(), &timeout, nullptr);
  }

  boards::LinuxSerial& serial_;
  LinuxAutopilot& autopilot_;
  Signals& signals_;
  std::vector<pollfd> set_;
};

/// Faults of link and motors, which are no modules that could be wrapped.
class Breaker final : public sim::LockStepListener {
 public:
  Breaker(SilWorld& world, boards::LinuxSerial& serial) : world_{world}, serial_{serial} {}
  void before_step(sim::Time t) override {
    world_.before_step(t);
    serial_.set_cut(world_.faults().active(sim::FaultKind::kLinkCut, t));
  }

 private:
  SilWorld& world_;
  boards::LinuxSerial& serial_;
};

void summarise(const boards::LinuxBoard& board, const LinuxAutopilot& firmware, const Pace& pace,
               std::uint64_t steps, double seconds) {
  const auto& link = board.serial.counters();
  std::cerr << fmt::format(
      "sil: ended after {:.1f} s: {} steps, {} passes, {} slips, {} restarts; link {} B in, {} B "
      "out, {} frames dropped\n",
      seconds, steps, board.system.passes(), pace.slips(), firmware.restarts(), link.bytes_received,
      link.bytes_sent, link.frames_dropped);
}

}  // namespace

int sil_command(const SilOptions& options, std::ostream& out,
                LinuxAutopilot::MakeCodec make_codec) {
  const sim::Time step = step_of(options);
  if (!make_codec) {
    make_codec = [&options](hal::Serial&) { return make_board_codec(options.link_protocol); };
  }
  const auto address = read_link(options);
  SilWorld world{options, step};
  Signals signals;
  const std::filesystem::path storage = options.storage.value_or(
      fmt::format("rosflight_{}.nvm", std::filesystem::path(options.vehicle).stem().string()));
  boards::LinuxBoard board{address, storage};
  LinuxAutopilot firmware{board, std::move(make_codec)};
  sim::LockStepTime time{step};
  sim::LockStep loop{time, world.rc(), world.sensors(), firmware, world.dynamics()};
  Breaker breaker{world, board.serial};
  loop.set_listener(&breaker);
  Waiter waiter{board.serial, firmware, signals};

  const hal::Time start = LinuxClock::steady();
  out << fmt::format("sil ready {} rate_Hz={} vehicle={} seed={} start_us={} nvm={}",
                     board.serial.where(), options.rate_Hz, options.vehicle, options.seed,
                     start.count(), storage.string())
      << std::endl;
  Pace pace{start, step};
  const auto seconds = [&loop] { return sim::to_seconds(loop.now()); };
  do {
    firmware.set_tick(pace.begin(LinuxClock::steady()));
    loop.step();
    pace.advance();
    if (options.duration_s && seconds() >= *options.duration_s) break;
  } while (waiter.wait_until(pace.tick()));
  summarise(board, firmware, pace, loop.ticks(), seconds());
  return 0;
}

}  // namespace rosflight::flight
