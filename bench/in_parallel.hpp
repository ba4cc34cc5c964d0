// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace rosflight::bench {

/// Calls worker(k) once for each k below `count`, several at once.
/// @param threads      0: one for each processor.
/// @param make_worker  called once by each thread; what it returns is used by this thread alone.
/// @throws what the first worker that fails throws, after all threads have ended.
template <class MakeWorker>
void in_parallel(std::size_t count, unsigned threads, const MakeWorker& make_worker) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&] {
    try {
      auto worker = make_worker();
      for (std::size_t k = next++; k < count && !stop; k = next++) worker(k);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
      stop = true;
    }
  };
  const unsigned wanted =
      threads == 0 ? std::max(1U, std::thread::hardware_concurrency()) : threads;
  std::vector<std::thread> helpers;
  for (unsigned k = 1; k < wanted; ++k) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace rosflight::bench
