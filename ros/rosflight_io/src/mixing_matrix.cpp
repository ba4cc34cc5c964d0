// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/mixing_matrix.hpp"

#include <array>
#include <cstdio>

namespace rosflight_io {
namespace {

constexpr int kChannels = 10;

std::string cell(const rosflight::companion::ParameterClient& parameters, const std::string& name) {
  const auto value = parameters.get(name);
  if (!value) return "         ?";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%10.4g", value->number());
  return text.data();
}

}  // namespace

std::string mixing_matrix_text(const rosflight::companion::ParameterClient& parameters) {
  constexpr std::array<const char*, 4> kKinds{"aux", "servo", "motor", "gpio"};
  std::string text = "outputs:";
  for (int k = 0; k < kChannels; ++k) {
    const auto kind = parameters.get("PRI_MIXER_OUT_" + std::to_string(k));
    const bool known = kind && kind->as_int32() >= 0 && kind->as_int32() < 4;
    text += std::string(" ") + (known ? kKinds[static_cast<std::size_t>(kind->as_int32())] : "?");
  }
  for (const char* mixer : {"PRI", "SEC"}) {
    text += std::string("\n") + mixer + " mixer, a row per input (Fx Fy Fz Qx Qy Qz and four free)";
    for (int row = 0; row < kChannels; ++row) {
      text += '\n';
      for (int column = 0; column < kChannels; ++column) {
        text += cell(parameters, std::string(mixer) + "_MIXER_" + std::to_string(row) + "_" +
                                     std::to_string(column));
      }
    }
  }
  return text;
}

}  // namespace rosflight_io
