// SPDX-License-Identifier: BSD-3-Clause
// What the compiler and the C library ask for in an image that has no heap and never ends. There is
// no operator new: an image that used the heap would not link.
#include <cstddef>

#include "firmware/boards/stm32h7/cpu.hpp"

// Virtual destructors name them; nothing is ever deleted.
void operator delete(void* /*object*/, std::size_t /*size*/) noexcept {}
void operator delete(void* /*object*/) noexcept {}

extern "C" {
void* __dso_handle = nullptr;  // NOLINT: the ABI's name
int __aeabi_atexit(void* /*object*/, void (* /*destroy*/)(void*), void* /*dso*/) {  // NOLINT
  return 0;
}
[[noreturn]] void __cxa_pure_virtual() {  // NOLINT
  rosflight::boards::stm32h7::reset_processor();
}
[[noreturn]] void abort() {
  rosflight::boards::stm32h7::reset_processor();
}
}
