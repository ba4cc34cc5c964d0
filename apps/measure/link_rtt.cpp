// SPDX-License-Identifier: BSD-3-Clause
// Round trip of offboard commands on the bare companion link, against sil_echo at its other end.
//
//     sil_link_rtt LINK --count N [--rate HZ | --window N] [--parameters] [--csv FILE]
//
// LINK as in base/transport/link_address.hpp. --rate sends steadily; --window keeps so many commands under
// way, as fast as they come back. --parameters reads the whole table over and over meanwhile.
// Prints one JSON object; the CSV has one line "number,round_trip_us" per command.
#include <CLI/CLI.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdio>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "companion/asio/runner.hpp"
#include "link/mavlink/mavlink_codec.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file
using companion::Runner;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kAsked = 9;      // u[9] of a command
constexpr std::size_t kAnswered = 13;  // values[13] of its answer

struct Options {
  std::string link;
  std::size_t count{10'000};
  double rate_Hz{0.0};
  std::size_t window{1};
  bool parameters{false};
  std::string csv;
};

class Measurement final : public companion::Listener {
 public:
  Measurement(Runner& runner, const Options& options)
      : runner_{runner}, options_{options}, timer_{runner.io()}, sent_(options.count + 1) {
    runner.session().add(*this);
  }

  /// From the moment all is quiet on the link.
  void begin() {
    if (options_.parameters) read_parameters();
    began_ = Clock::now();
    if (options_.rate_Hz > 0.0) {
      next_ = began_;
      tick();
    } else {
      for (std::size_t k = 0; k < options_.window; ++k) send();
    }
    give_up_later();
  }

  void on_output(const link::OutputRaw& m, const companion::Stamp& /*stamp*/) override {
    const auto number = static_cast<std::size_t>(m.values[kAnswered]);
    if (number == 0 || number > last_ || answered(number)) return;
    const auto now = Clock::now();
    us_[number - 1] = std::chrono::duration<double, std::micro>(now - sent_[number]).count();
    ended_ = now;
    ++answers_;
    if (answers_ == options_.count) {
      runner_.stop();
    } else if (options_.rate_Hz <= 0.0 && last_ < options_.count) {
      send();
    }
  }

  const std::vector<double>& round_trips_us() const { return us_; }
  std::size_t lost() const { return last_ - answers_; }
  double achieved_Hz() const {
    return static_cast<double>(answers_) / std::chrono::duration<double>(ended_ - began_).count();
  }

 private:
  bool answered(std::size_t number) const { return us_[number - 1] >= 0.0; }

  void send() {
    std::array<float, link::kCommandAxes> u{};
    const std::size_t number = ++last_;
    us_.push_back(-1.0);
    u[kAsked] = static_cast<float>(number);
    sent_[number] = Clock::now();
    const auto status = runner_.session().offboard().send(companion::pass_through(u));
    if (status != companion::SendStatus::kSent) ++refused_;
  }

  void tick() {
    if (last_ == options_.count) return;
    send();
    next_ += std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / options_.rate_Hz));
    timer_.expires_at(next_);
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (!error) tick();
    });
  }

  void read_parameters() {
    auto job = runner_.session().parameters().refresh();
    job.when_finished([this] { read_parameters(); });
  }

  /// Lost commands must not keep the program for ever: nothing new for a second ends it.
  void give_up_later() {
    watch_.expires_after(std::chrono::seconds(1));
    watch_.async_wait([this, before = answers_](const boost::system::error_code& error) {
      if (error) return;
      const bool all_sent = last_ == options_.count;
      if (before == answers_ && (all_sent || options_.rate_Hz <= 0.0)) {
        runner_.stop();
      } else {
        give_up_later();
      }
    });
  }

  Runner& runner_;
  const Options& options_;
  boost::asio::steady_timer timer_;
  boost::asio::steady_timer watch_{runner_.io()};
  std::vector<Clock::time_point> sent_;
  std::vector<double> us_;  ///< By number - 1; negative: not back.
  std::size_t last_{0};
  std::size_t answers_{0};
  std::size_t refused_{0};
  Clock::time_point next_, began_, ended_;
};

int measure(const Options& options) {
  link::MavlinkCodec codec({1, link::MavlinkCodec::kCompanionComponent});
  Runner runner(codec, companion::parse_link(options.link), {});
  Measurement measurement(runner, options);
  boost::asio::steady_timer poll(runner.io());
  std::function<void()> wait_for_list = [&] {
    if (runner.session().connected() && runner.session().parameters().complete()) {
      measurement.begin();
      return;
    }
    poll.expires_after(std::chrono::milliseconds(20));
    poll.async_wait([&](const boost::system::error_code& error) {
      if (!error) wait_for_list();
    });
  };
  boost::asio::steady_timer start_timeout(runner.io(), std::chrono::seconds(20));
  start_timeout.async_wait([&](const boost::system::error_code& error) {
    if (!error && measurement.round_trips_us().empty()) runner.stop();
  });
  runner.start();
  wait_for_list();
  runner.run();
  if (measurement.round_trips_us().empty())
    throw std::runtime_error("no autopilot at " + options.link);
  std::FILE* csv = options.csv.empty() ? nullptr : std::fopen(options.csv.c_str(), "w");
  if (!options.csv.empty() && csv == nullptr)
    throw std::runtime_error(options.csv + ": cannot be written");
  if (csv != nullptr) {
    std::fprintf(csv, "number,round_trip_us\n");
    std::size_t number = 0;
    for (const double us : measurement.round_trips_us()) {
      ++number;
      if (us >= 0.0) std::fprintf(csv, "%zu,%.3f\n", number, us);
    }
    std::fclose(csv);
  }
  std::cout << nlohmann::ordered_json{{"sent", measurement.round_trips_us().size()},
                                      {"lost", measurement.lost()},
                                      {"achieved_Hz", measurement.achieved_Hz()}}
            << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Round trips on the bare companion link"};
  Options options;
  app.add_option("LINK", options.link)->required();
  app.add_option("--count", options.count)->check(CLI::Range(1, 10'000'000));
  app.add_option("--rate", options.rate_Hz)->check(CLI::Range(0.1, 10'000.0));
  app.add_option("--window", options.window)->check(CLI::Range(1, 64));
  app.add_flag("--parameters", options.parameters);
  app.add_option("--csv", options.csv);
  try {
    CLI11_PARSE(app, argc, argv);
    return measure(options);
  } catch (const std::exception& error) {
    std::cerr << "sil_link_rtt: " << error.what() << "\n";
    return 2;
  }
}
