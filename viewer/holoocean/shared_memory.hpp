// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <semaphore.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "base/file_descriptor.hpp"

/// Shared memory and semaphores of POSIX under the engine's names.
namespace rosflight::viewer::holoocean {

/// The engine does not start, has ended, does not answer or is used by another client. One line.
class EngineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Block `/HOLODECK_MEM<name>_<key>`, made if it is not there and never made smaller: the engine may have mapped it.
class SharedBlock {
 public:
  /// What becomes of its name. An engine that runs on maps a block once for all its clients, so the name must stay.
  enum class AtEnd { kRemove, kKeep };

  /// @throws EngineError
  SharedBlock(const std::string& name, const std::string& key, std::size_t bytes, AtEnd at_end);
  SharedBlock(SharedBlock&& other) noexcept;
  SharedBlock& operator=(SharedBlock&&) = delete;
  SharedBlock(const SharedBlock&) = delete;
  SharedBlock& operator=(const SharedBlock&) = delete;
  /// Removes the name or not; who has mapped it keeps the memory.
  ~SharedBlock();

  std::span<std::byte> bytes() { return bytes_; }
  std::span<const std::byte> bytes() const { return bytes_; }
  /// Sets the first byte after all that was written before is visible to the engine.
  void set_flag(std::uint8_t value);
  std::uint8_t flag() const;
  /// Reserves the block while this object lives. @returns false if another has it.
  bool lock();
  void remove_at_end() { at_end_ = AtEnd::kRemove; }

 private:
  std::string path_;
  base::FileDescriptor file_;
  std::span<std::byte> bytes_;
  AtEnd at_end_;
};

/// A named semaphore.
class Semaphore {
 public:
  enum class Open { kExisting, kNew };
  /// kNew: value 0; must not exist yet. @throws EngineError
  Semaphore(std::string path, Open how);
  ~Semaphore();
  Semaphore(const Semaphore&) = delete;
  Semaphore& operator=(const Semaphore&) = delete;

  static bool exists(const std::string& path);
  void post();
  /// @returns false if the time is over.
  bool wait_for(std::chrono::milliseconds time);
  /// Removes the name with the object; a semaphore made here always.
  void remove_at_end() { remove_ = true; }

 private:
  std::string path_;
  sem_t* semaphore_{};
  bool remove_{};
};

/// A name for blocks and semaphores that nobody else has; it holds the number of this process.
std::string unique_name();
/// Removes blocks and semaphores with names of unique_name() whose process has ended. A process that is out of sight,
/// in another container with the same /dev/shm, has locked its block RESET. @returns how many.
int remove_leftovers();

}  // namespace rosflight::viewer::holoocean
