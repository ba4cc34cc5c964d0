// SPDX-License-Identifier: BSD-3-Clause
// What the compiler and the C library ask for in an image that has no heap and never ends. There is
// no operator new: an image that used the heap would not link.
#include <cstddef>

#include "firmware/boards/qemu_m7/registers.hpp"
#include "firmware/boards/qemu_m7/semihosting.hpp"

using namespace rosflight::boards::m7;  // NOLINT(google-build-using-namespace)

// Virtual destructors name them; nothing is ever deleted.
void operator delete(void* /*object*/, std::size_t /*size*/) noexcept {}
void operator delete(void* /*object*/) noexcept {}

extern "C" {
void* __dso_handle = nullptr;  // NOLINT: the ABI's name
int __aeabi_atexit(void* /*object*/, void (* /*destroy*/)(void*), void* /*dso*/) {  // NOLINT
  return 0;
}
[[noreturn]] void __cxa_pure_virtual() {  // NOLINT
  semihosting::print("pure virtual call\n");
  reset_processor();
}
[[noreturn]] void abort() {
  semihosting::print("abort\n");
  reset_processor();
}
}
