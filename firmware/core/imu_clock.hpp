// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware/hal/time.hpp"

namespace rosflight::core {

using hal::Time;

/// Why a sample was rejected.
enum class Reject : std::uint8_t {
  kNotFinite,         ///< A NaN, an infinity or a value beyond any sensor of the kind.
  kBackwards,         ///< IMU stamp before that of the previous sample.
  kOutlier,           ///< IMU stamp that does not fit the arrival.
  kStuck,             ///< Twenty equal IMU samples or stamps, or six zeros.
  kPressure,          ///< Static pressure outside 30..120 kPa.
  kRange,             ///< Any other sensor outside its range.
  kExternalAttitude,  ///< Far from the estimate, or no attitude.
  kGyroClipped,       ///< At full scale; counted by the gyro chain, not rejected.
};
inline constexpr std::size_t kRejects = 8;

/// Time steps from the stamps of IMU samples, checked against their arrival.
///
///     dt = stamp - stamp of the last usable sample,   |dt - its time of arrival| <= 50 ms    (1)
///
/// A sample whose stamp decreases or violates (1) is unusable: the caller treats it as missing, and
/// the next one is still compared with the last usable one. If three unusable samples in a row
/// satisfy (1) among each other, the clock of the IMU was set: the third is usable, and its dt is
/// the time since the arrival of the last usable one. A stamp equal to the last is usable with
/// dt = 0; after twenty equal stamps the clock counts as stopped, unusable until it moves.
/// The first sample is usable and has no dt. Some ten instructions a sample.
class ImuClock {
 public:
  static constexpr Time kTolerance = hal::milliseconds(50);
  static constexpr std::uint8_t kAgreeing = 3;
  static constexpr std::uint8_t kStanding = 20;

  struct Step {
    bool usable{false};
    bool backwards{false};  ///< Unusable because the stamp went back.
    bool restarted{false};  ///< First sample (dt_s is 0), or first after the clock was set.
    bool standing{false};   ///< Unusable because the stamp does not move.
    float dt_s{0.0f};       ///< Time step of a usable sample; >= 0.
  };

  /// @param arrival  board clock; does not go back.
  Step step(Time stamp, Time arrival) {
    const std::int64_t dt = difference(stamp, stamp_);
    const std::int64_t waited = (arrival - arrival_).count();
    if (dt <= 0 || !fits(dt, waited) || watching_) return examine(stamp, arrival, dt, waited);
    stamp_ = stamp;
    arrival_ = arrival;
    return {true, false, false, false, hal::seconds(Time{dt})};
  }

 private:
  /// Wraps instead of overflowing, whatever a driver hands over.
  static std::int64_t difference(Time a, Time b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a.count()) -
                                     static_cast<std::uint64_t>(b.count()));
  }
  static bool fits(std::int64_t dt, std::int64_t waited) {
    return dt <= waited + kTolerance.count() && dt >= waited - kTolerance.count();
  }
  Step examine(Time stamp, Time arrival, std::int64_t dt, std::int64_t waited);
  Step use(Time stamp, Time arrival, bool restarted, Time dt);

  Time stamp_{};    ///< Stamp of the last usable sample, the first with this stamp.
  Time arrival_{};  ///< Arrival of that sample.
  Time candidate_stamp_{};
  Time candidate_arrival_{};
  std::uint8_t candidates_{0};
  std::uint8_t equal_{1};  ///< Samples with stamp_.
  bool known_{false};
  bool watching_{true};  ///< Something is not as in a steady stream.
};

}  // namespace rosflight::core
