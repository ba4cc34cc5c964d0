// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/flash_storage.hpp"

#include <gtest/gtest.h>

#include "firmware/boards/parts/models/flash_model.hpp"
#include "firmware/core/parameter_store.hpp"
#include "firmware/hal/test/contract/storage_contract.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::milliseconds;
using hal::Time;

/// Time passes while somebody looks.
struct PassingTime final : hal::Clock {
  Time now() const override { return time += Time{20}; }
  mutable Time time{};
};

constexpr std::size_t kWords = 4096;

struct FlashBench {
  FlashBench() { storage.mount(); }
  /// Passes of the main loop on the ground until nothing is to be done.
  void rest() {
    for (int k = 0; k < 2000; ++k) {
      clock.time += milliseconds(2);
      storage.maintain();
    }
  }
  /// A reset with the power off in between.
  void reboot() {
    model.power_cycle();
    clock.time += milliseconds(1);
    storage.mount();
  }
  std::vector<std::uint8_t> read(std::size_t offset, std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    EXPECT_TRUE(storage.read(offset, bytes.data(), count)) << offset;
    return bytes;
  }
  bool write(std::size_t offset, const std::vector<std::uint8_t>& bytes) {
    return storage.write(offset, bytes.data(), bytes.size()) && storage.flush();
  }

  PassingTime clock;
  models::FlashModel model{kWords, [this] { return clock.now(); }};
  FlashStorage storage{model, clock};
};

struct FlashTraits {
  hal::Storage& role() {
    bench.rest();
    return bench.storage;
  }
  void power_cycle() { bench.reboot(); }
  FlashBench bench;
};

class FlashStorageTest : public testing::Test, protected FlashBench {};

TEST_F(FlashStorageTest, ANewPartReadsBlankAndCanBeWrittenAtOnce) {
  EXPECT_EQ(read(0, 64), std::vector<std::uint8_t>(64, 0xFF));
  EXPECT_TRUE(write(100, {1, 2, 3}));
  reboot();
  EXPECT_EQ(read(99, 5), (std::vector<std::uint8_t>{0xFF, 1, 2, 3, 0xFF}));
}

TEST_F(FlashStorageTest, APartThatWasUsedForSomethingElseIsErasedFirst) {
  model.fill_with_noise(3);
  storage.mount();
  EXPECT_FALSE(write(0, {1}));
  EXPECT_EQ(read(0, 24), std::vector<std::uint8_t>(24, 0xFF));
  rest();
  EXPECT_TRUE(write(0, {1}));
  rest();
  reboot();
  EXPECT_EQ(read(0, 1), std::vector<std::uint8_t>{1});
}

TEST_F(FlashStorageTest, UnchangedBytesCostNothing) {
  ASSERT_TRUE(write(0, std::vector<std::uint8_t>(480, 7)));
  const auto before = model.operations;
  ASSERT_TRUE(write(0, std::vector<std::uint8_t>(480, 7)));
  EXPECT_EQ(model.operations, before);
}

TEST_F(FlashStorageTest, ABlockOfParametersTakesLessThanAMillisecond) {
  ASSERT_TRUE(write(0, {1}));
  const Time begun = clock.time;
  ASSERT_TRUE(write(24 * 40 + 23, std::vector<std::uint8_t>(63, 9)));
  EXPECT_LE(clock.time - begun, Time{1500});
}

TEST_F(FlashStorageTest, ReadsAndWritesDoNotWaitForAnErasure) {
  ASSERT_TRUE(write(0, {1}));
  ASSERT_TRUE(model.erase(1));
  std::uint8_t byte = 0;
  const Time begun = clock.time;
  EXPECT_FALSE(storage.read(0, &byte, 1));
  EXPECT_FALSE(storage.write(0, &byte, 1));
  storage.maintain();
  EXPECT_LE(clock.time - begun, Time{200});
  EXPECT_TRUE(storage.busy());
  clock.time += milliseconds(1600);
  EXPECT_TRUE(storage.read(0, &byte, 1));
}

TEST_F(FlashStorageTest, GoesOnForTenThousandWritesAndNeverProgramsAWordTwice) {
  std::vector<std::uint8_t> expected(storage.size(), 0xFF);
  std::mt19937 random(5);
  for (int k = 0; k < 10'000; ++k) {
    const std::size_t offset = random() % (expected.size() - 64);
    std::vector<std::uint8_t> bytes(1 + random() % 63);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    ASSERT_TRUE(write(offset, bytes)) << k;
    std::copy(bytes.begin(), bytes.end(), expected.begin() + static_cast<std::ptrdiff_t>(offset));
    for (int pass = 0; pass < 5; ++pass) {
      storage.maintain();
      if (model.busy()) clock.time += milliseconds(1600);
    }
    if (random() % 500 == 0) reboot();
  }
  EXPECT_EQ(read(0, expected.size()), expected);
  EXPECT_EQ(model.twice, 0u);
}

TEST_F(FlashStorageTest, WordsThatDoNotHoldAreSkipped) {
  ASSERT_TRUE(write(0, {1}));
  model.worn_words = 2;
  ASSERT_TRUE(write(24, {2, 3}));
  EXPECT_EQ(read(24, 2), (std::vector<std::uint8_t>{2, 3}));
  model.worn_words = 20;
  EXPECT_FALSE(write(48, {4}));
  model.worn_words = 0;
  EXPECT_TRUE(write(48, {4}));
  reboot();
  EXPECT_EQ(read(48, 1), std::vector<std::uint8_t>{4});
  EXPECT_GE(storage.damaged_words(), 2u);
}

TEST_F(FlashStorageTest, AnErasureThatFailsIsTriedAgain) {
  model.fill_with_noise(3);
  model.fail_erase = true;
  storage.mount();
  for (int k = 0; k < 10; ++k) {
    storage.maintain();
    clock.time += milliseconds(1600);
  }
  EXPECT_FALSE(write(0, {1}));
  model.fail_erase = false;
  rest();
  rest();
  EXPECT_TRUE(write(0, {1}));
}

TEST_F(FlashStorageTest, AFullSectorWithoutAnErasedOneRefuses) {
  model.fail_erase = true;
  ASSERT_TRUE(write(0, {0}));
  model.damage(1, 77);
  storage.mount();  // the other sector is not erased
  int written = 0;
  while (written < 5000 && write(0, {static_cast<std::uint8_t>(written + 1)})) ++written;
  EXPECT_GT(written, 4000);
  EXPECT_LT(written, 4096);
  EXPECT_EQ(read(0, 1)[0], static_cast<std::uint8_t>(written));
}

// ---- a cut of power at any word

/// Writes until the sector changes, with the power cut at operation `cut`; every block is old or new.
TEST_F(FlashStorageTest, ACutAtAnyWordOfACopyLosesNothing) {
  for (std::uint64_t cut = 0; cut < 40; ++cut) {
    FlashBench bench;
    std::vector<std::uint8_t> content(24 * 30);
    // Up to the threshold of the copy, then the copy itself with marks, and the erasure.
    for (int k = 0; bench.model.operations < 3075; ++k) {
      content[static_cast<std::size_t>(k) * 24 % content.size()] = static_cast<std::uint8_t>(k);
      ASSERT_TRUE(bench.write(0, content));
    }
    bench.model.cut_after(cut, 0.1 * static_cast<double>(cut % 10));
    for (int k = 0; k < 100; ++k) {
      bench.storage.maintain();
      bench.clock.time += milliseconds(1);
    }
    bench.reboot();
    EXPECT_EQ(bench.read(0, content.size()), content) << cut;
    bench.rest();
    ASSERT_TRUE(bench.write(0, {0xAB})) << cut;
    bench.reboot();
    EXPECT_EQ(bench.read(0, 1)[0], 0xAB) << cut;
    EXPECT_EQ(bench.model.twice, 0u);
  }
}

TEST_F(FlashStorageTest, TheSectorWithOneGoodMarkIsFound) {
  ASSERT_TRUE(write(0, {1, 2, 3}));
  for (const std::size_t mark : {0u, 1u}) {
    FlashBench bench;
    ASSERT_TRUE(bench.write(0, {1, 2, 3}));
    bench.model.damage(0, mark);
    bench.reboot();
    EXPECT_EQ(bench.read(0, 3), (std::vector<std::uint8_t>{1, 2, 3})) << mark;
    EXPECT_EQ(bench.storage.damaged_words(), 1u);
  }
}

TEST_F(FlashStorageTest, ADamagedWordInFlightIsRefusedAndRepairedByTheNextWrite) {
  ASSERT_TRUE(write(0, {1, 2, 3}));
  model.damage(0, 2);
  std::uint8_t byte = 0;
  EXPECT_FALSE(storage.read(0, &byte, 1));
  EXPECT_TRUE(write(0, {4}));
  EXPECT_EQ(read(0, 1)[0], 4);
}

// ---- with the parameters of the firmware on top

class ParametersOnFlash : public testing::Test {
 protected:
  /// @returns which of the values a start finds, or -1.
  static int found(FlashBench& bench) {
    core::Parameters parameters;
    core::ParameterStore store{bench.storage};
    core::ParameterStore::LoadReport report;
    if (store.load(parameters, report) != core::StoreResult::kOk) return -1;
    return parameters.get_int(core::Param::kSysId);
  }
  static core::StoreResult save(FlashBench& bench, int value) {
    core::Parameters parameters;
    EXPECT_EQ(parameters.set_int(core::Param::kSysId, value), core::SetResult::kChanged);
    core::ParameterStore store{bench.storage};
    return store.save(parameters);
  }
};

TEST_F(ParametersOnFlash, ACutAtAnyWordOfASaveLeavesTheOldOrTheNewSet) {
  int old_sets = 0;
  int new_sets = 0;
  for (std::uint64_t cut = 0;; ++cut) {
    FlashBench bench;
    bench.rest();
    ASSERT_EQ(save(bench, 7), core::StoreResult::kOk);
    ASSERT_EQ(save(bench, 8), core::StoreResult::kOk);
    bench.model.cut_after(cut);
    static_cast<void>(save(bench, 9));
    if (bench.model.powered()) break;
    bench.reboot();
    const int value = found(bench);
    ASSERT_TRUE(value == 8 || value == 9) << value << " after a cut at word " << cut;
    ++(value == 8 ? old_sets : new_sets);
  }
  EXPECT_GT(old_sets, 2);
  EXPECT_GE(old_sets + new_sets, 3);
}

TEST_F(ParametersOnFlash, AnyDamagedWordLeavesASetThatWasSaved) {
  for (std::size_t word = 0; word < kWords; ++word) {
    FlashBench bench;
    bench.rest();
    ASSERT_EQ(save(bench, 7), core::StoreResult::kOk);
    ASSERT_EQ(save(bench, 8), core::StoreResult::kOk);
    if (!bench.model.used(0, word)) break;
    bench.model.damage(0, word);
    bench.reboot();
    const int value = found(bench);
    ASSERT_TRUE(value == 7 || value == 8) << value << " with word " << word << " damaged";
  }
}

}  // namespace
}  // namespace rosflight::boards::parts

namespace rosflight::hal::contract {
INSTANTIATE_TYPED_TEST_SUITE_P(Flash, StorageContract, boards::parts::FlashTraits);
}
