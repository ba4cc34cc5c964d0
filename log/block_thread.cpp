// SPDX-License-Identifier: BSD-3-Clause
#include "log/block_thread.hpp"

#include <utility>

namespace rosflight::log {

BlockThread::BlockThread(Work work) : work_(std::move(work)), thread_([this] { run(); }) {}

BlockThread::~BlockThread() {
  end_thread(true);
}

void BlockThread::put(Block& block) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < kDepth || error_; });
  if (error_) std::rethrow_exception(error_);
  waiting_.push_back(std::move(block));
  if (spare_.empty()) {
    block = Block{};
  } else {
    block = std::move(spare_.back());
    spare_.pop_back();
  }
  lock.unlock();
  changed_.notify_all();
}

void BlockThread::finish() {
  end_thread(false);
  if (error_) std::rethrow_exception(error_);
}

void BlockThread::end_thread(bool drop_waiting) {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
    if (drop_waiting) waiting_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void BlockThread::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return !waiting_.empty() || end_; });
    if (waiting_.empty()) return;
    Block block = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    changed_.notify_all();
    std::exception_ptr error;
    try {
      work_(block);
    } catch (...) {
      error = std::current_exception();
    }
    block.bytes.clear();
    block.index.clear();
    lock.lock();
    spare_.push_back(std::move(block));
    if (error) {
      error_ = error;
      waiting_.clear();
      changed_.notify_all();
      return;
    }
  }
}

}  // namespace rosflight::log
