# SPDX-License-Identifier: BSD-3-Clause
# The companion's computer (Raspberry Pi, Jetson), cross-built with Debian's compiler and its arm64 packages (multiarch).
# Programs of the build run under qemu-user, which needs no other root: multiarch has put the arm64 libraries in place.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
find_program(ROSFLIGHT_ARM64_COMPILER aarch64-linux-gnu-g++)
find_program(ROSFLIGHT_ARM64_EMULATOR qemu-aarch64)
if(NOT ROSFLIGHT_ARM64_COMPILER OR NOT ROSFLIGHT_ARM64_EMULATOR)
  message(FATAL_ERROR "aarch64-linux-gnu-g++ or qemu-aarch64 is not installed: tools/ready.sh packages run test arm64")
endif()
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR ${ROSFLIGHT_ARM64_EMULATOR})
set(yaml-cpp_DIR ${CMAKE_CURRENT_LIST_DIR}/arm64)
