// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "log/byte_buffer.hpp"

namespace rosflight::log {

/// Processes blocks of bytes in a thread of its own, in the order in which they were put. At most
/// kDepth blocks wait: a producer that is faster than the thread blocks in put().
///
/// The first exception of the function ends the work: later blocks are dropped and every following
/// put() and finish() throws it again, in the caller's thread.
class BlockThread {
 public:
  struct Block {
    ByteBuffer bytes{0};
    ByteBuffer index{0};  ///< What the function needs besides; may be empty.
  };
  using Work = std::function<void(Block&)>;
  static constexpr std::size_t kDepth = 2;

  explicit BlockThread(Work work);
  /// Blocks that still wait are dropped.
  ~BlockThread();
  BlockThread(const BlockThread&) = delete;
  BlockThread& operator=(const BlockThread&) = delete;

  /// Hands over `block`, which is empty afterwards and has the memory of an earlier one.
  void put(Block& block);

  /// Waits until every block is done and ends the thread. put() may not be called afterwards.
  void finish();

 private:
  void run();
  void end_thread(bool drop_waiting);

  Work work_;
  std::mutex mutex_;  ///< Protects all members below but the thread.
  std::condition_variable changed_;
  std::deque<Block> waiting_;
  std::vector<Block> spare_;
  std::exception_ptr error_;
  bool end_{false};
  std::thread thread_;  ///< Last: uses all others.
};

}  // namespace rosflight::log
