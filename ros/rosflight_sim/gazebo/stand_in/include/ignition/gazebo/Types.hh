// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>

namespace ignition::gazebo {
inline namespace v6 {

using Entity = std::uint64_t;
constexpr Entity kNullEntity{0};

struct UpdateInfo {
  std::chrono::steady_clock::duration simTime{0};
  std::chrono::steady_clock::duration realTime{0};
  std::chrono::steady_clock::duration dt{0};
  std::uint64_t iterations{0};
  bool paused{true};
};

}  // namespace v6
}  // namespace ignition::gazebo
