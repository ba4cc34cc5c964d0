// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/common/host/one_processor.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

namespace rosflight::boards {
namespace {

cpu_set_t allowed_of(pid_t process) {
  cpu_set_t set;
  CPU_ZERO(&set);
  EXPECT_EQ(::sched_getaffinity(process, sizeof set, &set), 0);
  return set;
}

/// A child that waits for its end.
class Child {
 public:
  Child() : id{::fork()} {
    while (id == 0) ::pause();
  }
  ~Child() {
    ::kill(id, SIGKILL);
    ::waitpid(id, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  const pid_t id;
};

TEST(OneProcessor, BothAreOnTheSameOneAndFreeAgainAtTheEnd) {
  const cpu_set_t before = allowed_of(0);
  const Child child;
  std::optional<OneProcessor> together(std::in_place);
  together->next_turn(child.id);
  together->next_turn(child.id);
  const cpu_set_t mine = allowed_of(0), its = allowed_of(child.id);
  EXPECT_EQ(CPU_COUNT(&mine), 1);
  EXPECT_TRUE(CPU_EQUAL(&mine, &its));
  together.reset();
  const cpu_set_t after = allowed_of(0);
  EXPECT_TRUE(CPU_EQUAL(&after, &before));
}

TEST(OneProcessor, IsChosenAnewAllTheTime) {
  const cpu_set_t before = allowed_of(0);
  const Child child;
  OneProcessor together;
  constexpr int kTurns = 10'000;
  int free = 0;
  for (int turn = 0; turn < kTurns; ++turn) {
    together.next_turn(child.id);
    const cpu_set_t now = allowed_of(0);
    if (CPU_EQUAL(&now, &before)) ++free;
  }
  const bool has_a_choice = CPU_COUNT(&before) > 1;
  EXPECT_EQ(free, has_a_choice ? 5 : kTurns);
}

TEST(OneProcessor, ADeadChildIsNoError) {
  pid_t gone = 0;
  { gone = Child().id; }
  OneProcessor together;
  for (int turn = 0; turn < 3; ++turn) together.next_turn(gone);
  const cpu_set_t mine = allowed_of(0);
  EXPECT_EQ(CPU_COUNT(&mine), 1);
}

}  // namespace
}  // namespace rosflight::boards
