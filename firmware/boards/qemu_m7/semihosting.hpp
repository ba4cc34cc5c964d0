// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

/// Calls to the debugger, here the emulator: the processor stands still until they are answered
/// (Semihosting for AArch32 and AArch64, Arm IHI 2020).
namespace rosflight::boards::m7::semihosting {

inline int call(int operation, const void* arguments) {
  register int r0 asm("r0") = operation;
  register const void* r1 asm("r1") = arguments;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

inline std::uint32_t address(const void* pointer) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pointer));
}

/// Writes to the emulator's standard error.
inline void print(const char* text) {
  call(0x04, text);
}

/// `mode` as in the standard: 1 reads, 5 writes. @returns a handle, or -1.
inline int open(const char* path, std::size_t length, std::uint32_t mode) {
  const std::uint32_t arguments[3] = {address(path), mode, static_cast<std::uint32_t>(length)};
  return call(0x01, arguments);
}

/// Waits for one byte. @returns false when there will be no more.
inline bool read_byte(int handle, char& byte) {
  const std::uint32_t arguments[3] = {static_cast<std::uint32_t>(handle), address(&byte), 1};
  return call(0x06, arguments) == 0;  // the answer is what was not read
}

inline void write_byte(int handle, char byte) {
  const std::uint32_t arguments[3] = {static_cast<std::uint32_t>(handle), address(&byte), 1};
  call(0x05, arguments);
}

/// Ends the emulator with this status.
[[noreturn]] inline void exit(int status) {
  constexpr std::uint32_t kApplicationExit = 0x20026u;
  const std::uint32_t arguments[2] = {kApplicationExit, static_cast<std::uint32_t>(status)};
  call(0x20, arguments);
  for (;;) asm volatile("wfi");
}

}  // namespace rosflight::boards::m7::semihosting
