// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "autonomy/estimation/error_state_ekf.hpp"

namespace rosflight::autonomy::estimation {

/// Recognises a sudden fault by what it does to the innovations of all aids together, and gives the
/// filter what it would have had, had it allowed for the fault from the start.
///
/// A fault is a step of unknown size b of one error (an axis of the gyro or of the accelerometer, or the
/// wind north or east), b ~ N(0, s^2), that began at one of several onsets. A step of size one leaves a
/// filter that does not know of it with the error m, which grows as errors do, and which each scalar
/// correction with the gain K reduces:
///
///     m <- F m,     h = H m,     m <- m - K h                                             (1)
///
/// The innovation has the mean b h then, and the variance S as before. Over all innovations since the
/// onset, the size of the step and the evidence (Bayes factor) for it against no fault are
///
///     L = sum h^2/S,  d = sum h nu/S:   b ~ N(d c, c),  c = 1/(L + 1/s^2)                 (2)
///     log B = d^2 c/2 - log(1 + s^2 L)/2                                                  (3)
///
/// Once the mean of B over the hypotheses, kHypotheses of them, exceeds a limit, the filter takes their
/// mixture with weights B, which has the mean and covariance (4) of its parts, and the watch begins again:
///
///     x <- x [+] sum p m d c,   P <- P + sum p m m' (c + d^2 c^2) - mean mean'            (4)
///
/// Without a fault B is a martingale of mean one, so that it ever exceeds the limit has at most the
/// probability of one over the limit for each onset (J. Ville, 1939), as far as the model holds.
///
/// (1), (2): B. Friedland, "Treatment of bias in recursive filtering", IEEE Trans. Automatic Control 14,
/// 1969; A. S. Willsky, H. L. Jones, "A generalized likelihood ratio approach to the detection and
/// estimation of jumps in linear systems", ibid. 21, 1976. (4): Y. Bar-Shalom, X. Li, T. Kirubarajan,
/// "Estimation with Applications to Tracking and Navigation", 2001, eq. (1.4.16).
class StepWatch {
 public:
  using Filter = ErrorStateEkf;

  /// Standard deviation of what is assumed of a step.
  struct Sizes {
    double gyro_rad_s{0.1};
    double accel_m_s2{0.5};
    double wind_m_s{2.0};
  };

  StepWatch() : StepWatch(Sizes{}) {}
  /// @param used  false: it takes no room, and predict() may not be called.
  explicit StepWatch(const Sizes& sizes, bool used = true) : sizes_{sizes}, room_(used ? 1U : 0U) {
    restart();
  }

  /// Forgets all innovations: there is no onset until the next prediction.
  void restart();
  /// Carries (1) over an increment; x is the state before it. Begins a new onset every second, in place of
  /// the oldest.
  void predict(const NominalState& x, const ImuIncrement& u, const ProcessNoise& noise);
  /// A scalar residual and what the filter made of it: (1), (2). A rejected one does not count.
  void observe(const Filter::Residual<1>& residual, const Filter::Verdict& verdict);
  /// Corrects the filter by (4) and restarts, if the evidence exceeds the limit.
  /// @returns whether it did.
  bool decide(Filter& filter);

  bool running() const { return begun_ > 0; }
  /// Logarithm of the mean Bayes factor.
  double log_evidence() const;

 private:
  static constexpr int kSteps = 8;   ///< Three axes of the gyro, three of the accelerometer, wind.
  static constexpr int kOnsets = 8;  ///< The last of these seconds.
  static constexpr int kHypotheses = kSteps * kOnsets;
  using Row = Eigen::Matrix<double, 1, kHypotheses>;

  void begin_onset();
  Row log_factors() const;

  Sizes sizes_;
  struct Hypotheses {
    Eigen::Matrix<double, Filter::kSize, kHypotheses> errors;  ///< m of each.
    Row variance{Row::Ones()};                                 ///< s^2 of each.
    Row information, drive;                                    ///< L and d of each.
  };
  std::vector<Hypotheses> room_;  ///< One, of 16 kB, or none.
  int begun_{0};                  ///< Onsets so far.
  double since_s_{0.0};           ///< The last one began.
};

}  // namespace rosflight::autonomy::estimation
