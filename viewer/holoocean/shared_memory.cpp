// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/shared_memory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>

namespace rosflight::viewer::holoocean {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kEveryone = 0777;  // as the engine makes them
constexpr const char* kSharedMemory = "/dev/shm";
constexpr std::string_view kOurs = "rosflight_";
constexpr std::size_t kRandomDigits = 16;

[[noreturn]] void fail(const std::string& what) {
  throw EngineError(fmt::format("{}: {}", what, std::strerror(errno)));
}

std::string block_path(const std::string& name, const std::string& key) {
  return fmt::format("/HOLODECK_MEM{}_{}", name, key);
}

/// The name of unique_name() in the name of a file, with its process; nothing: it has none.
struct OurName {
  std::string name;
  pid_t process{0};
};
std::optional<OurName> our_name(const std::string& file) {
  const std::size_t at = file.find(kOurs);
  if (file.find("HOLODECK_") == std::string::npos || at == std::string::npos) return std::nullopt;
  OurName ours;
  const char* const number = file.data() + at + kOurs.size();
  const char* const end = file.data() + file.size();
  const auto [rest, error] = std::from_chars(number, end, ours.process);
  const auto length = static_cast<std::size_t>(rest - number) + 1 + kRandomDigits;
  if (error != std::errc{} || ours.process <= 0 || at + kOurs.size() + length > file.size())
    return std::nullopt;
  ours.name = file.substr(at, kOurs.size() + length);
  return ours;
}

/// Whether the client of this name has ended. While `lock` is held no other can take the name.
bool has_ended(const OurName& ours, base::FileDescriptor& lock) {
  if (::kill(ours.process, 0) == 0 || errno != ESRCH) return false;
  lock = base::FileDescriptor{::shm_open(block_path(ours.name, "RESET").c_str(), O_RDWR, 0)};
  return !lock.valid() || ::flock(lock.get(), LOCK_EX | LOCK_NB) == 0;
}

}  // namespace

SharedBlock::SharedBlock(const std::string& name, const std::string& key, std::size_t bytes,
                         AtEnd at_end)
    : path_{block_path(name, key)},
      file_{::shm_open(path_.c_str(), O_RDWR | O_CREAT, kEveryone)},
      at_end_{at_end} {
  if (!file_.valid()) fail("shared memory " + path_);
  struct stat status {};
  ::fstat(file_.get(), &status);
  // posix_fallocate() reserves the memory now; with ftruncate() a full /dev/shm would be a SIGBUS later.
  if (static_cast<std::size_t>(status.st_size) < bytes) {
    const int error = ::posix_fallocate(file_.get(), 0, static_cast<off_t>(bytes));
    if (error != 0) {
      ::shm_unlink(path_.c_str());
      errno = error;
      fail(fmt::format("shared memory {} of {} bytes", path_, bytes));
    }
  }
  void* const mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), 0);
  if (mapped == MAP_FAILED) fail("shared memory " + path_);
  bytes_ = {static_cast<std::byte*>(mapped), bytes};
}

SharedBlock::SharedBlock(SharedBlock&& other) noexcept
    : path_{std::exchange(other.path_, {})},
      file_{std::move(other.file_)},
      bytes_{std::exchange(other.bytes_, {})},
      at_end_{other.at_end_} {}

SharedBlock::~SharedBlock() {
  if (bytes_.empty()) return;
  ::munmap(bytes_.data(), bytes_.size());
  if (at_end_ == AtEnd::kRemove) ::shm_unlink(path_.c_str());
}

void SharedBlock::set_flag(std::uint8_t value) {
  std::atomic_ref<std::uint8_t>(*reinterpret_cast<std::uint8_t*>(bytes_.data()))
      .store(value, std::memory_order_release);
}

std::uint8_t SharedBlock::flag() const {
  return std::atomic_ref<std::uint8_t>(*reinterpret_cast<std::uint8_t*>(bytes_.data()))
      .load(std::memory_order_acquire);
}

bool SharedBlock::lock() {
  return ::flock(file_.get(), LOCK_EX | LOCK_NB) == 0;
}

Semaphore::Semaphore(std::string path, Open how) : path_{std::move(path)} {
  semaphore_ = how == Open::kNew ? ::sem_open(path_.c_str(), O_CREAT | O_EXCL, kEveryone, 0)
                                 : ::sem_open(path_.c_str(), 0);
  if (semaphore_ == SEM_FAILED) fail("semaphore " + path_);
  remove_ = how == Open::kNew;
}

Semaphore::~Semaphore() {
  ::sem_close(semaphore_);
  if (remove_) ::sem_unlink(path_.c_str());
}

bool Semaphore::exists(const std::string& path) {
  sem_t* const found = ::sem_open(path.c_str(), 0);
  if (found == SEM_FAILED) return false;
  ::sem_close(found);
  return true;
}

void Semaphore::post() {
  ::sem_post(semaphore_);
}

bool Semaphore::wait_for(std::chrono::milliseconds time) {
  constexpr std::int64_t kMsPerS = 1000;
  constexpr std::int64_t kNsPerMs = 1'000'000;
  constexpr std::int64_t kNsPerS = kMsPerS * kNsPerMs;
  timespec end{};
  ::clock_gettime(CLOCK_MONOTONIC, &end);  // the time of day may be set meanwhile
  const std::int64_t nanoseconds = end.tv_nsec + time.count() % kMsPerS * kNsPerMs;
  end.tv_sec += time.count() / kMsPerS + nanoseconds / kNsPerS;
  end.tv_nsec = nanoseconds % kNsPerS;
  while (::sem_clockwait(semaphore_, CLOCK_MONOTONIC, &end) != 0) {
    if (errno != EINTR) return false;
  }
  return true;
}

std::string unique_name() {
  std::random_device random;
  return fmt::format("{}{}_{:08x}{:08x}", kOurs, ::getpid(), random(), random());
}

int remove_leftovers() {
  struct Client {
    base::FileDescriptor lock;
    bool ended{false};
  };
  int removed = 0;
  std::error_code ignored;
  std::map<std::string, Client> clients;
  for (const fs::directory_entry& entry : fs::directory_iterator(kSharedMemory, ignored)) {
    const std::string file = entry.path().filename().string();
    const auto ours = our_name(file);
    if (!ours) continue;
    const auto [client, is_new] = clients.try_emplace(ours->name);
    if (is_new) client->second.ended = has_ended(*ours, client->second.lock);
    if (client->second.ended && fs::remove(entry.path(), ignored)) ++removed;
  }
  return removed;
}

}  // namespace rosflight::viewer::holoocean
