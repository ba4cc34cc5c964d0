// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/estimation/health.hpp"
#include "flight/report/flight_record.hpp"
#include "messages/rosflight_log_msgs.hpp"
#include "sim/types.hpp"

namespace rosflight::flight {

using LoggedEstimate = messages::rosflight_log_msgs::Estimate;

/// The estimate as log and report show it.
LoggedEstimate logged(const autonomy::StateEstimate& estimate,
                      const autonomy::estimation::EstimatorHealth& health);

/// Keeps what the report tells of an estimate: errors against the truth, innovations, what is
/// trusted.
class EstimateRecord {
 public:
  /// Of the moment.
  /// @param seen_W  the true position less what no filter on board can see.
  report::Estimate sample(const autonomy::StateEstimate& estimate,
                          const autonomy::estimation::EstimatorHealth& health,
                          const sim::Truth& truth, const sim::Vector3& seen_W);

  /// Lanes of the report: what position and heading rest on, and which aids are refused.
  void follow(report::FlightRecord& record, double t_s, const autonomy::StateEstimate& estimate,
              const autonomy::estimation::EstimatorHealth& health);

 private:
  struct Mean {
    std::uint64_t count{};  ///< Measurements seen.
    double value{};
    double t_s{-1e9};
  };
  std::array<Mean, autonomy::estimation::kAids> innovations_{};
  bool refused_{false};  ///< Something was, once.
};

}  // namespace rosflight::flight
