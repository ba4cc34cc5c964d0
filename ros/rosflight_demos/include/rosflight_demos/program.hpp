// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdio>
#include <exception>

/// The frame of a main(): one line and exit code 2 for what cannot be understood.
template <class Run>
int program(const char* name, Run run) {
  constexpr int kBadInput = 2;
  try {
    return run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return kBadInput;
  }
}
