// SPDX-License-Identifier: BSD-3-Clause
// What newlib asks of an operating system, answered by the emulator: a heap, files of the host, and
// a start with arguments. For test images only.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/time.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "firmware/boards/qemu_m7/semihosting.hpp"
#include "firmware/boards/qemu_m7/startup.hpp"

using namespace rosflight::boards::m7;  // NOLINT(google-build-using-namespace)

extern "C" {
extern char end[], board_heap_end[];
int target_main(int argc, char** argv);
}

namespace {

constexpr int kWrite = 0x05, kRead = 0x06, kOpen = 0x01, kClose = 0x02, kSeek = 0x0A;
constexpr int kLength = 0x0C, kTime = 0x11, kCommandLine = 0x15;
constexpr int kFirstFile = 8;  // below: standard input, output, error
char* heap = end;

std::uint32_t word(int value) {
  return static_cast<std::uint32_t>(value);
}

int console(bool error) {
  constexpr std::uint32_t kForOutput = 4, kForError = 8;
  return semihosting::open(":tt", 3, error ? kForError : kForOutput);
}

int handle_of(int file) {
  return file < kFirstFile ? console(file == 2) : file - kFirstFile;
}

}  // namespace

extern "C" {

void* __dso_handle = nullptr;  // NOLINT: the name is the ABI's

void _init() {}  // NOLINT
void _fini() {}  // NOLINT

void* _sbrk(std::ptrdiff_t more) {  // NOLINT: newlib's names, here and below
  if (heap + more > board_heap_end) {
    errno = ENOMEM;
    return reinterpret_cast<void*>(-1);
  }
  char* const before = heap;
  heap += more;
  return before;
}

int _open(const char* path, int flags, int /*mode*/) {  // NOLINT
  constexpr std::uint32_t kReadMode = 1, kWriteMode = 5, kAppendMode = 9;
  const bool append = (flags & O_APPEND) != 0;
  const std::uint32_t mode = (flags & O_ACCMODE) == O_RDONLY ? kReadMode
                             : append                        ? kAppendMode
                                                             : kWriteMode;
  const int handle = semihosting::open(path, std::strlen(path), mode);
  return handle < 0 ? -1 : handle + kFirstFile;
}

int _close(int file) {  // NOLINT
  const std::uint32_t arguments[1] = {word(handle_of(file))};
  return file < kFirstFile ? 0 : semihosting::call(kClose, arguments);
}

int _write(int file, const char* data, int size) {  // NOLINT
  const std::uint32_t arguments[3] = {word(handle_of(file)), semihosting::address(data),
                                      word(size)};
  return size - semihosting::call(kWrite, arguments);
}

int _read(int file, char* data, int size) {  // NOLINT
  const std::uint32_t arguments[3] = {word(handle_of(file)), semihosting::address(data),
                                      word(size)};
  return size - semihosting::call(kRead, arguments);
}

int _lseek(int file, int offset, int whence) {  // NOLINT
  const std::uint32_t length_of[1] = {word(handle_of(file))};
  const int from = whence == SEEK_END ? semihosting::call(kLength, length_of) : 0;
  const std::uint32_t arguments[2] = {word(handle_of(file)), word(from + offset)};
  return semihosting::call(kSeek, arguments) == 0 ? from + offset : -1;
}

int _fstat(int file, struct stat* status) {  // NOLINT
  *status = {};
  status->st_mode = file < kFirstFile ? S_IFCHR : S_IFREG;
  return 0;
}
int _stat(const char* /*path*/, struct stat* status) {  // NOLINT
  *status = {};
  status->st_mode = S_IFDIR;  // the folder that a report goes to is there
  return 0;
}
int _isatty(int /*file*/) {
  return 0;
}  // NOLINT
int _unlink(const char* /*path*/) {
  return -1;
}  // NOLINT
int mkdir(const char* /*path*/, mode_t /*mode*/) {
  return 0;
}
char* getcwd(char* path, std::size_t size) {
  return std::strncpy(path, ".", size);
}
int _getpid() {
  return 1;
}  // NOLINT
int _kill(int /*process*/, int /*signal*/) {
  semihosting::exit(99);
}  // NOLINT
[[noreturn]] void _exit(int status) {
  semihosting::exit(status);
}  // NOLINT
int _gettimeofday(struct timeval* now, void* /*zone*/) {  // NOLINT
  *now = {};
  now->tv_sec = semihosting::call(kTime, nullptr);
  return 0;
}

void board_fault(const FaultRegisters& registers) {
  std::printf("fault at pc %08lx lr %08lx\n", registers[6], registers[5]);
  std::fflush(stdout);
  semihosting::exit(98);
}

/// Words of the emulator's arg= settings, separated by blanks.
int board_main() {
  constexpr int kMaxArguments = 16;
  static char line[512];
  static char* words[kMaxArguments + 1];
  struct {
    char* text;
    int size;
  } wanted{line, sizeof line};
  asm volatile("cpsie i" ::: "memory");
  int count = 0;
  if (semihosting::call(kCommandLine, &wanted) == 0) {
    for (char* at = std::strtok(line, " "); at != nullptr && count < kMaxArguments;
         at = std::strtok(nullptr, " ")) {
      words[count++] = at;
    }
  }
  const int status = target_main(count, words);
  std::fflush(nullptr);
  return status;
}
}
