// SPDX-License-Identifier: BSD-3-Clause
// A serial cable between a companion and `sil`: byte times and finite queues of sim::SerialLine in
// real time, and noise on it.
//
//     sil_cable --board udp:HOST:PORT --listen PORT [--baud N] [--corrupt P [--one-way]] [--seed N]
//
// Prints "cable ready link=pty:PATH" when the companion can open PATH; ends on SIGINT or SIGTERM
// with one line of counters on stderr.
#include <fmt/format.h>
#include <sys/prctl.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "firmware/boards/linux/linux_clock.hpp"
#include "firmware/boards/linux/linux_serial.hpp"
#include "flight/sil/signals.hpp"
#include "link/mavlink/mavlink_codec.hpp"
#include "sim/serial_cable.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file
using boards::LinuxClock;

struct Options {
  std::string board;
  std::uint16_t listen{};
  sim::SerialLine::Config line;
  double corruption{0.0};
  bool one_way{false};
  std::uint64_t seed{1};
};

/// Both ends of the cable, in the order bytes take.
class Cable {
 public:
  explicit Cable(const Options& options)
      : companion_{base::parse_board_link("pty")},
        board_{board_address(options)},
        to_board_{line(options, true), sim::RandomSource{options.seed}.stream("to_board")},
        to_companion_{line(options, !options.one_way),
                      sim::RandomSource{options.seed}.stream("to_companion")} {}

  std::string where() const { return companion_.where(); }
  bool busy() const { return to_board_.queued() + to_companion_.queued() > 0; }
  void add_to(std::vector<pollfd>& set) const { companion_.add_to(set), board_.add_to(set); }

  void step(hal::Time now) {
    take(companion_, [&](const std::uint8_t* data, std::size_t size) {
      static_cast<void>(to_board_.push(now, data, size, hal::Serial::kOrdinary));
    });
    take(board_,
         [&](const std::uint8_t* data, std::size_t size) { queue_frames(now, data, size); });
    give(to_board_, board_, now);
    give(to_companion_, companion_, now);
  }

  void summarise() const {
    const auto line_of = [](const char* name, const sim::SerialLine::Counters& c) {
      return fmt::format("{} {} bytes, {} corrupted, {} frames dropped", name, c.bytes_sent,
                         c.bytes_corrupted, c.frames_dropped[sim::SerialLine::kOrdinary]);
    };
    std::cerr << fmt::format("cable: {}; {}\n", line_of("to board", to_board_.counters()),
                             line_of("to companion", to_companion_.counters()));
  }

 private:
  static base::LinkAddress board_address(const Options& options) {
    auto address = base::parse_board_link(options.board);
    address.local_port = options.listen;
    return address;
  }
  static sim::SerialLine::Config line(const Options& options, bool noisy) {
    auto config = options.line;
    config.corruption_per_byte = noisy ? options.corruption : 0.0;
    return config;
  }

  template <class Push>
  void take(boards::LinuxSerial& from, Push push) {
    from.receive();
    while (const std::size_t size = from.read(chunk_.data(), chunk_.size()))
      push(chunk_.data(), size);
  }
  /// The board's own queue, which this stands for, lets urgent frames go first.
  void queue_frames(hal::Time now, const std::uint8_t* data, std::size_t size) {
    for (std::size_t used = 0; used < size;) {
      const auto result = reader_.decode(data + used, size - used);
      frame_.insert(frame_.end(), data + used, data + used + result.consumed);
      used += result.consumed;
      if (!result.complete) continue;
      static_cast<void>(to_companion_.push(now, frame_.data(), frame_.size(), urgency()));
      frame_.clear();
    }
  }
  std::uint8_t urgency() const {
    const auto* output = std::get_if<link::OutputRaw>(&reader_.message());
    const bool echo = output != nullptr && output->time_boot_ms == 0;  // echo_main.hpp
    const bool imu = std::holds_alternative<link::Imu>(reader_.message());
    return echo || imu ? hal::Serial::kUrgent : hal::Serial::kOrdinary;
  }
  void give(sim::SerialLine& line, boards::LinuxSerial& to, hal::Time now) {
    while (const std::size_t size = line.pop(now, chunk_.data(), chunk_.size()))
      static_cast<void>(to.write(chunk_.data(), size, hal::Serial::kOrdinary));
    to.transmit();
  }

  boards::LinuxSerial companion_;
  boards::LinuxSerial board_;
  sim::SerialLine to_board_;
  sim::SerialLine to_companion_;
  std::array<std::uint8_t, 1024> chunk_{};
  link::MavlinkCodec reader_{{1, link::MavlinkCodec::kCompanionComponent}};
  std::vector<std::uint8_t> frame_;  ///< As far as it has come.
};

void relay(const Options& options) {
  flight::Signals signals;
  Cable cable{options};
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  std::cout << "cable ready " << cable.where() << std::endl;
  std::vector<pollfd> set;
  do {
    cable.step(LinuxClock::steady());
    set.assign(1, {signals.fd(), POLLIN, 0});
    cable.add_to(set);
    // While bytes are on the wire, some arrive every so often; otherwise until something happens.
    const timespec soon{0, 30'000};
    const timespec later{0, 20'000'000};
    ::ppoll(set.data(), set.size(), cable.busy() ? &soon : &later, nullptr);
  } while (!signals.take());
  cable.summarise();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"A serial cable in real time"};
  Options options;
  app.add_option("--board", options.board)->required();
  app.add_option("--listen", options.listen)->required();
  app.add_option("--baud", options.line.baud)->check(CLI::Range(300, 100'000'000));
  app.add_option("--corrupt", options.corruption)->check(CLI::Range(0.0, 1.0));
  app.add_flag("--one-way", options.one_way, "only bytes to the board are corrupted");
  app.add_option("--seed", options.seed);
  try {
    CLI11_PARSE(app, argc, argv);
    relay(options);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "sil_cable: " << error.what() << "\n";
    return 2;
  }
}
