// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/estimation/estimator.hpp"
#include "sim/world_sensors/samples.hpp"

namespace rosflight::flight {

/// Where the companion gets its state estimate from.
class StateEstimateSource {
 public:
  StateEstimateSource() = default;
  StateEstimateSource(const StateEstimateSource&) = delete;
  StateEstimateSource& operator=(const StateEstimateSource&) = delete;
  virtual ~StateEstimateSource() = default;

  /// The newest estimate; its frame begins at origin().
  virtual autonomy::StateEstimate estimate() const = 0;
  virtual const autonomy::estimation::EstimatorHealth& health() const = 0;
  /// Position on the earth of the local frame; empty before the first fix.
  virtual const std::optional<autonomy::Geodetic>& origin() const = 0;
  /// The newest pose of a motion capture system, as it arrives. Default: not used.
  virtual void add(const sim::PoseSample& pose) { static_cast<void>(pose); }
  /// Forgets everything measured so far.
  virtual void restart() = 0;
  /// false: samples are ignored. Called with true once the firmware is calibrated.
  virtual void set_enabled(bool enabled) = 0;
};

}  // namespace rosflight::flight
