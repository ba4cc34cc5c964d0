// SPDX-License-Identifier: BSD-3-Clause
#include "sim/random.hpp"

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace detail {
namespace {
/// Where the tail starts and the common area of the 256 layers (Marsaglia & Tsang 2000, recomputed
/// to 16 digits).
constexpr double kTailStart = 3.6541528853610088;
constexpr double kLayerArea = 0.004928673233974658;

constexpr double bell(double x) {
  return portable::exp(-0.5 * x * x);
}

constexpr double square_root(double x) {
  double y = x < 1.0 ? 1.0 : x;
  for (int i = 0; i < 60; ++i) y = 0.5 * (y + x / y);
  return y;
}

/// edge[0] = area / f(r) makes the layer with the tail as wide as its area wants; then downwards to
/// edge[256] = 0.
constexpr Ziggurat make_ziggurat() {
  Ziggurat z;
  z.edge[0] = kLayerArea / bell(kTailStart);
  z.edge[1] = kTailStart;
  z.height[0] = 0.0;
  z.height[1] = bell(kTailStart);
  for (unsigned i = 2; i < kZigguratLayers; ++i) {
    z.height[i] = z.height[i - 1] + kLayerArea / z.edge[i - 1];
    z.edge[i] = square_root(-2.0 * portable::log(z.height[i]));
  }
  z.height[kZigguratLayers] = 1.0;
  z.edge[kZigguratLayers] = 0.0;
  return z;
}
}  // namespace

constinit const Ziggurat kZiggurat = make_ziggurat();

}  // namespace detail

double RandomStream::normal_outside(std::uint64_t draw) {
  const detail::Ziggurat& z = detail::kZiggurat;
  for (;;) {
    const auto layer = draw & 0xFFU;
    const double sign = (draw & 0x100U) != 0U ? -1.0 : 1.0;
    const double x = static_cast<double>(draw >> 11U) * 0x1p-53 * z.edge[layer];
    if (x < z.edge[layer + 1]) return sign * x;
    if (layer == 0) {
      // Tail beyond r after Marsaglia (1964): exponential proposal of rate r, accepted under the
      // curve.
      double tail = 0.0;
      double test = 0.0;
      do {
        tail = -portable::log(1.0 - uniform()) / detail::kTailStart;
        test = -portable::log(1.0 - uniform());
      } while (2.0 * test < tail * tail);
      return sign * (detail::kTailStart + tail);
    }
    const double y = z.height[layer] + uniform() * (z.height[layer + 1] - z.height[layer]);
    if (y < detail::bell(x)) return sign * x;
    draw = bits();
  }
}

}  // namespace rosflight::sim
