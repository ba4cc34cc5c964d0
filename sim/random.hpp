// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

/// Randomness of the simulation: one 64-bit seed gives every number, the same on every machine.
///
///     RandomSource source{seed};
///     RandomStream gusts = source.stream("wind/gust");   // independent of all other names
///     double w = 2.0 * gusts.normal();
///
/// Each consumer has a stream of its own name, so a new one does not change the numbers of another.
///
/// Generator: xoshiro256++ 1.0 (D. Blackman, S. Vigna, "Scrambled linear pseudorandom number
/// generators", ACM Trans. Math. Softw. 47, 2021), state filled by SplitMix64 (G. Steele et al.,
/// OOPSLA 2014) from the seed and the FNV-1a 64-bit hash of the name (Internet draft
/// draft-eastlake-fnv). Standard normal: ziggurat of 256 layers (G. Marsaglia, W. W. Tsang, J.
/// Stat. Softw. 5(8), 2000) with layer, sign and abscissa from disjoint bits of one 64-bit draw,
/// which removes the correlation Doornik found (2005). All arithmetic is +, -, *, /
/// (sim/portable_math.hpp), never the C library.
namespace rosflight::sim {

/// SplitMix64: advances `state`, returns the next output.
constexpr std::uint64_t split_mix_64(std::uint64_t& state) {
  state += 0x9E37'79B9'7F4A'7C15U;
  std::uint64_t z = state;
  z = (z ^ (z >> 30U)) * 0xBF58'476D'1CE4'E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D0'49BB'1331'11EBU;
  return z ^ (z >> 31U);
}

/// FNV-1a, 64 bits.
constexpr std::uint64_t stable_hash(std::string_view text) {
  std::uint64_t hash = 0xCBF2'9CE4'8422'2325U;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x0000'0100'0000'01B3U;
  }
  return hash;
}

/// One sequence of random numbers. A value: copies continue alike and apart. 32 bytes.
class RandomStream {
 public:
  /// @param state  not all zero.
  explicit constexpr RandomStream(const std::array<std::uint64_t, 4>& state) : s_{state} {}

  /// 64 independent bits.
  constexpr std::uint64_t bits() {
    const std::uint64_t result = rotate_left(s_[0] + s_[3], 23) + s_[0];
    const std::uint64_t t = s_[1] << 17U;
    s_[2] ^= s_[0];
    s_[3] ^= s_[1];
    s_[1] ^= s_[2];
    s_[0] ^= s_[3];
    s_[2] ^= t;
    s_[3] = rotate_left(s_[3], 45);
    return result;
  }

  /// Uniform on [0, 1), a multiple of 2^-53.
  constexpr double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  /// Uniform on [low, high).
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Normal with mean 0 and variance 1. A few ns; 98.8 % of draws leave by the first return.
  double normal();

 private:
  static constexpr std::uint64_t rotate_left(std::uint64_t x, unsigned k) {
    return (x << k) | (x >> (64U - k));
  }
  /// Outside the rectangles: the wedge of a layer, or the tail below layer 0.
  double normal_outside(std::uint64_t bits);

  std::array<std::uint64_t, 4> s_;
};

/// Makes the named streams of one seed.
class RandomSource {
 public:
  /// @param seed  from which every stream follows.
  explicit constexpr RandomSource(std::uint64_t seed) : seed_{seed} {}

  /// The stream of a name; the same name gives the same numbers.
  constexpr RandomStream stream(std::string_view name) const {
    std::uint64_t state = mixed(name);
    std::array<std::uint64_t, 4> s{};
    for (auto& word : s) word = split_mix_64(state);
    return RandomStream{s};
  }
  /// A source of its own, for a second vehicle or the n-th flight of a campaign.
  constexpr RandomSource child(std::string_view name) const { return RandomSource{mixed(name)}; }
  constexpr std::uint64_t seed() const { return seed_; }

 private:
  constexpr std::uint64_t mixed(std::string_view name) const {
    std::uint64_t state = seed_;
    return split_mix_64(state) ^ stable_hash(name);
  }

  std::uint64_t seed_;
};

namespace detail {
inline constexpr unsigned kZigguratLayers = 256;
/// Layer i spans |x| < edge[i]; inside |x| < edge[i + 1] it lies wholly under the curve
/// exp(-x^2/2).
struct Ziggurat {
  std::array<double, kZigguratLayers + 1> edge{};
  std::array<double, kZigguratLayers + 1> height{};
};
extern const Ziggurat kZiggurat;
}  // namespace detail

/// Standard normal number (ziggurat).
inline double RandomStream::normal() {
  const std::uint64_t draw = bits();
  const auto layer = draw & 0xFFU;
  const double x = static_cast<double>(draw >> 11U) * 0x1p-53 * detail::kZiggurat.edge[layer];
  if (x < detail::kZiggurat.edge[layer + 1]) return (draw & 0x100U) != 0U ? -x : x;
  return normal_outside(draw);
}

}  // namespace rosflight::sim
