// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/visualiser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace rosflight::viewer::holoocean {
namespace {

constexpr std::int64_t kUsPerS = 1'000'000;

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

Visualiser::Visualiser(const Scenario& scenario, Engine::Options options, Pace pace,
                       Receivers receivers)
    : scenario_{scenario},
      options_{std::move(options)},
      pace_{pace},
      receivers_{std::move(receivers)} {
  options_.interrupted = [this, asked = std::move(options_.interrupted)] {
    return interrupted() || (asked && asked());
  };
  thread_ = std::thread([this] { run(); });
}

Visualiser::~Visualiser() {
  close();
}

void Visualiser::step(const sim::Truth& truth, const hal::OutputValues& /*outputs*/) {
  show(truth.body, truth.time);
}

void Visualiser::show(const sim::BodyState& body, std::chrono::nanoseconds time) {
  const auto t = std::chrono::floor<sim::Time>(time);
  if (t < last_) next_tick_ = 0;  // another flight
  last_ = t;
  // Tick n belongs to the first step at or after n / ticks_per_s.
  if (t.count() * scenario_.ticks_per_s < next_tick_ * kUsPerS) return;
  next_tick_ = t.count() * scenario_.ticks_per_s / kUsPerS + 1;
  std::unique_lock lock(mutex_);
  if (counts_.failed || closing_) return;
  if (pending_) ++counts_.skipped;
  pending_ = State{time, body};
  changed_.notify_all();
  if (pace_ == Pace::kSkip) return;
  changed_.wait(lock, [this] { return (!pending_ && !busy_) || counts_.failed || closing_; });
}

void Visualiser::reset() {
  const std::lock_guard lock(mutex_);
  reset_ = true;
}

Visualiser::Counts Visualiser::close() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
  return counts();
}

Visualiser::Counts Visualiser::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

bool Visualiser::started() const {
  const std::lock_guard lock(mutex_);
  return started_ || counts_.failed;
}

void Visualiser::wait_until_started() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return started_ || counts_.failed || closing_; });
}

std::string Visualiser::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

bool Visualiser::interrupted() const {
  const std::lock_guard lock(mutex_);
  return closing_;
}

void Visualiser::run() {
  try {
    Engine engine(scenario_, options_);
    if (receivers_.note) receivers_.note("the engine has loaded its world");
    {
      const std::lock_guard lock(mutex_);
      started_ = true;
      changed_.notify_all();
    }
    serve(engine);
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void Visualiser::serve(Engine& engine) {
  for (;;) {
    State state;
    bool reset = false;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return pending_ || closing_; });
      if (closing_ || !pending_) return;
      state = *pending_;
      pending_.reset();
      reset = std::exchange(reset_, false);
      busy_ = true;
    }
    if (reset) engine.reset();
    SensorFrame frame = engine.tick(state.time, state.body);
    const std::size_t images = frame.images.size();
    const bool contact = frame.in_contact.value_or(false);
    if (receivers_.frame) receivers_.frame(std::move(frame));
    const std::lock_guard lock(mutex_);
    ++counts_.ticks;
    counts_.images += images;
    counts_.contacts += contact ? 1 : 0;
    busy_ = false;
    changed_.notify_all();
  }
}

void Visualiser::fail(const std::string& why) {
  {
    const std::lock_guard lock(mutex_);
    if (closing_) return;
    counts_.failed = true;
    failure_ = one_line(why);
    changed_.notify_all();
  }
  if (receivers_.note) {
    receivers_.note(fmt::format("warning: {}; the flight goes on without it", failure()));
  }
}

}  // namespace rosflight::viewer::holoocean
