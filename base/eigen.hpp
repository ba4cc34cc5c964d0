// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

// The same bits on every processor. On arm64 Eigen 3.4 has packets of two floats beside those of four and adds three numbers
// as (a + b) + c with them; elsewhere it adds a + (b + c), as it does with packets of four alone.
#if defined(EIGEN_VECTORIZE_NEON)
namespace Eigen::internal {

template <int Size>
struct find_best_packet_helper<Size, Packet4f, false> {
  using type = Packet4f;
};

}  // namespace Eigen::internal
#endif
