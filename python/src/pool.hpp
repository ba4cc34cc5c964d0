// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace rosflight::python {

/// Threads that share the items of one call after the other. What an item computes must not depend on the
/// others, so the result is that of one thread.
class Pool {
 public:
  /// @param threads  at least 1, the calling one included.
  explicit Pool(std::size_t threads) {
    for (std::size_t k = 1; k < threads; ++k) workers_.emplace_back([this] { work(); });
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;
  ~Pool() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    begin_.notify_all();
    for (std::thread& worker : workers_) worker.join();
  }

  /// Calls item(k) for 0 <= k < count and returns when all are done. @throws what the first failed one threw.
  template <class F>
  void for_each(std::size_t count, const F& item) {
    if (workers_.empty() || count < 2) {
      for (std::size_t k = 0; k < count; ++k) item(k);
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      item_ = item;
      count_ = count;
      // Few pieces, so that threads seldom meet at the counter, but enough for an even end.
      constexpr std::size_t kPieces = 8;
      piece_ = std::max<std::size_t>(1, count / (kPieces * (workers_.size() + 1)));
      next_ = 0;
      working_ = workers_.size();
      ++round_;
    }
    begin_.notify_all();
    take_items();
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return working_ == 0; });
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  void take_items() {
    try {
      for (std::size_t first = next_.fetch_add(piece_); first < count_;
           first = next_.fetch_add(piece_)) {
        for (std::size_t k = first; k < std::min(first + piece_, count_); ++k) item_(k);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      next_ = count_;
    }
  }
  void work() {
    std::size_t seen = 0;
    std::unique_lock lock(mutex_);
    for (;;) {
      begin_.wait(lock, [&] { return ending_ || round_ != seen; });
      if (ending_) return;
      seen = round_;
      lock.unlock();
      take_items();
      lock.lock();
      if (--working_ == 0) done_.notify_one();
    }
  }

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable begin_, done_;
  std::function<void(std::size_t)> item_;
  std::atomic<std::size_t> next_{0};
  std::size_t count_{0};
  std::size_t piece_{1};
  std::size_t working_{0};
  std::size_t round_{0};
  std::exception_ptr error_;
  bool ending_{false};
};

}  // namespace rosflight::python
