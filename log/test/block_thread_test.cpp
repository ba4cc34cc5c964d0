// SPDX-License-Identifier: BSD-3-Clause
#include "log/block_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>

namespace rosflight::log {
namespace {

void put(BlockThread& thread, std::uint8_t value) {
  BlockThread::Block block;
  block.bytes.put(value);
  thread.put(block);
  EXPECT_EQ(block.bytes.size(), 0U);
  EXPECT_EQ(block.index.size(), 0U);
}

TEST(BlockThread, DoesAllBlocksInOrder) {
  std::string done;
  BlockThread thread(
      [&](BlockThread::Block& block) { done += static_cast<char>(block.bytes.bytes()[0]); });
  std::string expected;
  for (int k = 0; k < 1000; ++k) {
    expected += static_cast<char>('a' + k % 26);
    put(thread, static_cast<std::uint8_t>(expected.back()));
  }
  thread.finish();
  EXPECT_EQ(done, expected);
}

TEST(BlockThread, AProducerWaitsWhenTheQueueIsFull) {
  std::atomic<bool> go{false};
  std::atomic<int> accepted{0};
  std::atomic<int> done{0};
  BlockThread thread([&](BlockThread::Block&) {
    go.wait(false);
    ++done;
  });
  constexpr int kMany = 3 * static_cast<int>(BlockThread::kDepth);
  std::thread producer([&] {
    for (int k = 0; k < kMany; ++k) {
      put(thread, 0);
      ++accepted;
    }
  });
  // One block is in work, kDepth wait; the next one does not fit.
  constexpr int kFull = 1 + static_cast<int>(BlockThread::kDepth);
  while (accepted < kFull) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(accepted, kFull);
  go = true;
  go.notify_all();
  producer.join();
  thread.finish();
  EXPECT_EQ(done, kMany);
}

TEST(BlockThread, TheFirstErrorReachesTheCallerAndEndsTheWork) {
  std::atomic<int> calls{0};
  BlockThread thread([&](BlockThread::Block& block) {
    ++calls;
    if (block.bytes.bytes()[0] == 2) throw std::runtime_error("disk full");
  });
  std::string error;
  try {
    for (std::uint8_t k = 0; k < 100; ++k) put(thread, k);
  } catch (const std::runtime_error& e) {
    error = e.what();
  }
  EXPECT_EQ(error, "disk full");
  EXPECT_THROW(put(thread, 0), std::runtime_error);
  EXPECT_THROW(thread.finish(), std::runtime_error);
  EXPECT_EQ(calls, 3);
}

TEST(BlockThread, WithoutFinishWaitingBlocksAreDropped) {
  std::atomic<bool> go{false};
  std::atomic<int> calls{0};
  std::thread release;
  {
    BlockThread thread([&](BlockThread::Block&) {
      ++calls;
      go.wait(false);
    });
    for (int k = 0; k < 3; ++k) put(thread, 0);
    while (calls == 0) std::this_thread::yield();
    release = std::thread([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));  // Time for the destructor.
      go = true;
      go.notify_all();
    });
  }
  release.join();
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace rosflight::log
