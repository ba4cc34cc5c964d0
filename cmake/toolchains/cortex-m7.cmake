# SPDX-License-Identifier: BSD-3-Clause
# Bare-metal Cortex-M7 with double-precision FPU (STM32H7 class), GNU Arm toolchain of the distribution.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
find_program(ROSFLIGHT_ARM_COMPILER arm-none-eabi-g++)
if(NOT ROSFLIGHT_ARM_COMPILER)
  message(FATAL_ERROR "arm-none-eabi-g++ is not installed: it comes with the package gcc-arm-none-eabi")
endif()
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(cpu "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard -ffunction-sections -fdata-sections")
set(CMAKE_C_FLAGS_INIT "${cpu}")
set(CMAKE_CXX_FLAGS_INIT "${cpu}")
