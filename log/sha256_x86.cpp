// SPDX-License-Identifier: BSD-3-Clause
// SHA-256 with the SHA instructions of x86-64 processors (Intel 64 and IA-32 Architectures Software
// Developer's Manual, volume 1, section 12.3: SHA256RNDS2, SHA256MSG1, SHA256MSG2); other machines
// take the portable code.
#include "log/sha256.hpp"

#if defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>
#endif

namespace rosflight::log {

#if defined(__x86_64__)
namespace {

__m128i load(const void* p) {
  return _mm_loadu_si128(static_cast<const __m128i*>(p));
}
void store(void* p, __m128i value) {
  _mm_storeu_si128(static_cast<__m128i*>(p), value);
}

/// The instructions want the eight words as (F E B A) and (H G D C), lowest first.
__attribute__((target("sha,sse4.1"))) void compress_x86(Sha256::State& state,
                                                        const std::uint8_t* blocks,
                                                        std::size_t count) {
  const __m128i swap_bytes = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  const __m128i cdab = _mm_shuffle_epi32(load(state.data()), 0xB1);
  const __m128i efgh = _mm_shuffle_epi32(load(state.data() + 4), 0x1B);
  __m128i abef = _mm_alignr_epi8(cdab, efgh, 8);
  __m128i cdgh = _mm_blend_epi16(efgh, cdab, 0xF0);

  for (; count > 0; --count, blocks += 64) {
    const __m128i abef_before = abef;
    const __m128i cdgh_before = cdgh;
    __m128i w[4];  // Sixteen words of the message schedule.
    for (std::size_t k = 0; k < 4; ++k) w[k] = _mm_shuffle_epi8(load(blocks + 16 * k), swap_bytes);
#pragma GCC unroll 16
    for (std::size_t k = 0; k < 16; ++k) {
      const __m128i sum = _mm_add_epi32(w[k % 4], load(kSha256Rounds.data() + 4 * k));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(sum, 0x0E));
      if (k >= 12) continue;
      const __m128i next = _mm_add_epi32(_mm_sha256msg1_epu32(w[k % 4], w[(k + 1) % 4]),
                                         _mm_alignr_epi8(w[(k + 3) % 4], w[(k + 2) % 4], 4));
      w[k % 4] = _mm_sha256msg2_epu32(next, w[(k + 3) % 4]);
    }
    abef = _mm_add_epi32(abef, abef_before);
    cdgh = _mm_add_epi32(cdgh, cdgh_before);
  }

  const __m128i feba = _mm_shuffle_epi32(abef, 0x1B);
  const __m128i dchg = _mm_shuffle_epi32(cdgh, 0xB1);
  store(state.data(), _mm_blend_epi16(feba, dchg, 0xF0));
  store(state.data() + 4, _mm_alignr_epi8(dchg, feba, 8));
}

bool has_sha_instructions() {
  constexpr unsigned kShaBit = 1U << 29U;
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  return __builtin_cpu_supports("sse4.1") != 0 && __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 &&
         (b & kShaBit) != 0;
}

}  // namespace

Sha256::Compress Sha256::fastest() {
  return has_sha_instructions() ? compress_x86 : compress_portable;
}
#else
Sha256::Compress Sha256::fastest() {
  return compress_portable;
}
#endif

}  // namespace rosflight::log
