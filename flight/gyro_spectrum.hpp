// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <complex>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

namespace rosflight::flight {

/// Amplitude densities of the gyro, three axes together [rad/s per square root of Hz], as the
/// sensor gave it and as the firmware's controller takes it.
struct GyroSpectrum {
  std::vector<double> frequency_Hz;
  std::vector<double> before;
  std::vector<double> after;
  double latency_s{std::numeric_limits<double>::quiet_NaN()};  ///< For slow motion.
};

/// Spectra of a rate before and after a filter, and the time between them, by the method of Welch
/// (1967): segments of N samples, half of them shared with the next, less their mean, under a Hann
/// window w,
///
///     X_k = sum_n w_n x_n exp(-2 pi i k n / N)                           (1)
///     density(f_k)^2 = 2 mean(|X_k|^2) / (rate sum_n w_n^2)              (2)
///     delay = - sum c_k f_k arg(S_k) / (2 pi sum c_k f_k^2),
///             S_k = mean(conj(X_k) Y_k),
///             c_k = |S_k| / sqrt(mean(|X_k|^2) mean(|Y_k|^2))            (3)
///
/// (2) adds the three axes, (3) takes frequencies up to kMaxDelay_Hz: the delay of slow motion.
/// P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15 (2), 1967.
class Spectrum {
 public:
  using Rates = std::array<float, 3>;  ///< [rad/s]
  static constexpr std::size_t kSegment = 256;
  static constexpr double kMaxDelay_Hz = 15.0;

  Spectrum();
  Spectrum(Spectrum&&) noexcept;
  Spectrum& operator=(Spectrum&&) noexcept;
  ~Spectrum();

  /// The next sample of both, taken at the same moment.
  void add(const Rates& before, const Rates& after);
  /// What comes next does not join what came before.
  void gap() { filled_ = 0; }
  std::size_t segments() const { return segments_; }

  /// @param rate_Hz  of the samples. Empty curves without a whole segment; no latency (NaN) if the
  /// two signals have little in common.
  GyroSpectrum result(double rate_Hz) const;

 private:
  using Complex = std::complex<double>;
  using Segment = std::array<double, kSegment>;
  static constexpr std::size_t kLines = kSegment / 2 + 1;

  void take_segment();
  void transform(const Segment& x, std::array<Complex, kLines>& out);

  Segment window_{};
  struct Transform;
  std::unique_ptr<Transform> transform_;
  std::array<Segment, 3> before_{};
  std::array<Segment, 3> after_{};
  std::size_t filled_{0};
  std::size_t segments_{0};
  std::array<double, kLines> power_before_{};
  std::array<double, kLines> power_after_{};
  std::array<Complex, kLines> cross_{};
};

}  // namespace rosflight::flight
