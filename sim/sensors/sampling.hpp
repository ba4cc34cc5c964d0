// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <utility>

#include "sim/noise.hpp"
#include "sim/sample_clock.hpp"
#include "sim/types.hpp"

/// Times of measurement and of delivery of an instrument.
namespace rosflight::sim::sensors {

/// Adds clock and delay to an instrument. An instrument has a type `Sample` and a function
/// `bool measure(const Truth&, Sample&)`, which returns false without a result (no echo, no fix).
template <class Instrument>
class Scheduled {
 public:
  using Sample = typename Instrument::Sample;

  /// @param instrument  measures at the times of `timing`.
  Scheduled(const Timing& timing, Instrument instrument)
      : clock_{timing},
        delayed_{timing.delay > Time{0}},
        line_{timing.delay, timing.period},
        instrument_{std::move(instrument)} {}

  /// Call once per step. @returns true if a sample became available.
  bool step(const Truth& truth, Sample& sample) {
    if (clock_.due(truth.time)) {
      if (!delayed_) return instrument_.measure(truth, sample);
      Sample fresh;
      if (instrument_.measure(truth, fresh)) line_.push(truth.time, fresh);
    }
    return delayed_ && line_.pop(truth.time, sample);
  }

  const Instrument& instrument() const { return instrument_; }

 private:
  SampleClock clock_;
  bool delayed_;
  DelayLine<Sample> line_;
  Instrument instrument_;
};

/// Air temperature plus self-heating; or, if `fixed_K` is above 0, that alone.
struct Temperature {
  double rise_K{};
  double fixed_K{};

  /// Temperature at the time of the truth [K].
  double at(const Truth& truth) const {
    return fixed_K > 0.0 ? fixed_K : truth.air.temperature_K + rise_K;
  }
};

}  // namespace rosflight::sim::sensors
