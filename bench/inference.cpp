// SPDX-License-Identifier: BSD-3-Clause
// A policy of two layers of 64, inferred N times: what one inference costs. Run it under callgrind with
// two numbers and take the difference.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

#include "firmware/core/network.hpp"

namespace {

using namespace rosflight::core;
using Policy = Network<Dense<12, 64, Activation::kTanh>, Dense<64, 64, Activation::kTanh>,
                       Dense<64, 3, Activation::kTanh>>;

/// Different gains, small enough that no unit saturates.
template <class Numbers>
void fill(Numbers& numbers) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    numbers[k] = 0.1F * std::sin(static_cast<float>(k));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::int64_t count = 0;
  const char* const text = argc == 3 ? argv[2] : "";
  const char* const end = text + std::strlen(text);
  if (argc != 3 || std::string(argv[1]) != "--count" ||
      std::from_chars(text, end, count).ptr != end) {
    std::fputs("usage: inference --count N\n", stderr);
    return 2;
  }
  Policy::Table table{};
  fill(std::get<0>(table).gains);
  fill(std::get<1>(table).gains);
  fill(std::get<2>(table).gains);
  Policy::Inputs x{};
  x[2] = 1.0F;
  for (std::int64_t k = 0; k < count; ++k) {
    const auto y = Policy::step(table, nullptr, x);
    std::copy(y.begin(), y.end(), x.begin() + 9);  // the last output, as a policy sees it
  }
  std::printf("{\"output\": %.6f}\n", static_cast<double>(x[9]));
  return 0;
}
