// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/shared_memory.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "viewer/holoocean/test/standin.hpp"

namespace rosflight::viewer::holoocean {
namespace {

using namespace std::chrono_literals;
using AtEnd = SharedBlock::AtEnd;

/// unique_name() of a process that has ended.
std::string name_of_the_dead() {
  const pid_t dead = ::fork();
  if (dead == 0) ::_exit(0);
  ::waitpid(dead, nullptr, 0);
  return "rosflight_" + std::to_string(dead) + "_0123456789abcdef";
}

TEST(HoloOceanSharedMemory, LeftoversOfAClientThatWasKilledAreRemovedByTheNext) {
  const std::string theirs = name_of_the_dead();
  const std::string ours = unique_name();
  const std::string of_python = "3e1b1a66-rosflight";
  for (const std::string& name : {theirs, ours, of_python})
    std::ofstream("/dev/shm/HOLODECK_MEM" + name + "_RESET") << "x";
  std::ofstream("/dev/shm/sem.HOLODECK_SEMAPHORE_SERVER" + theirs) << "x";
  EXPECT_EQ(remove_leftovers(), 2);
  EXPECT_TRUE(left_of(theirs).empty());
  for (const std::string& name : {ours, of_python}) {
    EXPECT_EQ(left_of(name).size(), 1U);
    std::filesystem::remove("/dev/shm/HOLODECK_MEM" + name + "_RESET");
  }
}

TEST(HoloOceanSharedMemory, BlocksOfAClientInAnotherContainerStay) {
  // Its process has no number here, as if it had ended, but it holds the lock of its block RESET.
  const std::string theirs = name_of_the_dead();
  {
    SharedBlock reset(theirs, "RESET", 1, AtEnd::kKeep);
    const SharedBlock other(theirs, "command_bool", 1, AtEnd::kKeep);
    ASSERT_TRUE(reset.lock());
    EXPECT_EQ(remove_leftovers(), 0);
    EXPECT_EQ(left_of(theirs).size(), 2U);
  }
  EXPECT_EQ(remove_leftovers(), 2);
}

TEST(HoloOceanSharedMemory, ABlockStaysOrGoesWithItsObject) {
  const std::string name = unique_name();
  { const SharedBlock gone(name, "a", 8, AtEnd::kRemove); }
  EXPECT_TRUE(left_of(name).empty());
  { const SharedBlock stays(name, "a", 8, AtEnd::kKeep); }
  EXPECT_EQ(left_of(name).size(), 1U);
  { const SharedBlock smaller(name, "a", 4, AtEnd::kRemove); }
  EXPECT_TRUE(left_of(name).empty());
}

TEST(HoloOceanSharedMemory, ASemaphoreIsWaitedForAsLongAsAsked) {
  Semaphore semaphore("/HOLODECK_LOADING_SEM" + unique_name(), Semaphore::Open::kNew);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(semaphore.wait_for(1200ms));  // more than a second, for its carry
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 1200ms);
  semaphore.post();
  EXPECT_TRUE(semaphore.wait_for(1h));
}

}  // namespace
}  // namespace rosflight::viewer::holoocean
