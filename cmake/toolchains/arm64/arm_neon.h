// SPDX-License-Identifier: BSD-3-Clause
// The same bits on every processor: Eigen multiplies and adds by these names, with one rounding whatever -ffp-contract says.
// Here they round twice, as they do elsewhere.
#pragma once
#include_next <arm_neon.h>

#define vfmaq_f32(c, a, b) vaddq_f32((c), vmulq_f32((a), (b)))
#define vfmaq_f64(c, a, b) vaddq_f64((c), vmulq_f64((a), (b)))
#define vfma_f32(c, a, b) vadd_f32((c), vmul_f32((a), (b)))
#define vfmaq_n_f32(c, a, b) vaddq_f32((c), vmulq_n_f32((a), (b)))
#define vfmaq_n_f64(c, a, b) vaddq_f64((c), vmulq_n_f64((a), (b)))
#define vfmaq_laneq_f32(c, a, b, lane) vaddq_f32((c), vmulq_laneq_f32((a), (b), (lane)))
#define vfmaq_laneq_f64(c, a, b, lane) vaddq_f64((c), vmulq_laneq_f64((a), (b), (lane)))
