// SPDX-License-Identifier: BSD-3-Clause
// What newlib asks of an operating system: a heap in the AXI SRAM, and standard output on the link of the board. For test
// images only.
#include <sys/stat.h>
#include <sys/time.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>

#include "firmware/boards/stm32h7/test/contract_image.hpp"

using namespace rosflight::boards::stm32h7;  // NOLINT(google-build-using-namespace)

extern "C" {
// The names are those of newlib, of the linker script and of the ABI. NOLINTBEGIN
extern std::uint8_t board_record_begin[], board_record_end[];
void* __dso_handle = nullptr;

void _init() {}
void _fini() {}

void* _sbrk(std::ptrdiff_t more) {
  static std::uint8_t* heap = board_record_begin;
  if (more > board_record_end - heap) {
    errno = ENOMEM;
    return reinterpret_cast<void*>(-1);
  }
  std::uint8_t* const before = heap;
  heap += more;
  return before;
}

int _write(int /*file*/, const char* data, int size) {
  rosflight::hal::Serial& link = board_under_test().roles.serial;
  constexpr std::size_t kPiece = 32;
  unmask_bus(0);  // a test that holds the link and fails has to say so
  for (std::size_t at = 0; at < static_cast<std::size_t>(size);) {
    const std::size_t count = std::min(kPiece, static_cast<std::size_t>(size) - at);
    while (link.writable() < count) {
    }
    static_cast<void>(link.write(reinterpret_cast<const std::uint8_t*>(data) + at, count,
                                 rosflight::hal::Serial::kOrdinary));
    at += count;
  }
  return size;
}

int _open(const char* /*path*/, int /*flags*/, int /*mode*/) {
  return -1;
}
int _close(int /*file*/) {
  return 0;
}
int _read(int /*file*/, char* /*data*/, int /*size*/) {
  return 0;
}
int _lseek(int /*file*/, int /*offset*/, int /*whence*/) {
  return 0;
}
int _isatty(int /*file*/) {
  return 0;
}
int _unlink(const char* /*path*/) {
  return -1;
}
int _getpid() {
  return 1;
}
int mkdir(const char* /*path*/, mode_t /*mode*/) {
  return -1;
}
char* getcwd(char* path, std::size_t /*size*/) {
  return path[0] = '.', path[1] = 0, path;
}
int _stat(const char* /*path*/, struct stat* /*status*/) {
  return -1;
}
int _fstat(int /*file*/, struct stat* status) {
  *status = {};
  status->st_mode = S_IFCHR;
  return 0;
}
int _gettimeofday(struct timeval* now, void* /*zone*/) {
  return now->tv_sec = 0, now->tv_usec = 0, 0;
}
int _kill(int /*process*/, int /*signal*/) {
  reset_processor();
}
[[noreturn]] void _exit(int /*status*/) {
  reset_processor();
}
// NOLINTEND
}
