// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/parameter_store_rig.hpp"

namespace rosflight::core {
namespace {

/// A medium whose reads fail, or lie, from the n-th on.
class FlakyStorage final : public hal::Storage {
 public:
  explicit FlakyStorage(hal::Storage& good) : good_{good} {}
  std::size_t size() const override { return good_.size(); }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override {
    const bool bad = reads_++ >= good_reads;
    if (bad && !lies) return false;
    const bool ok = good_.read(offset, data, count);
    if (bad) data[count - 1] ^= 1u;
    return ok;
  }
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override {
    return good_.write(offset, data, count);
  }
  bool flush() override { return good_.flush(); }

  std::size_t reads() const { return reads_; }
  std::size_t good_reads{~std::size_t{0}};
  bool lies{false};

 private:
  hal::Storage& good_;
  std::size_t reads_{0};
};

TEST(ParameterStore, AMediumThatFailsHalfwayLeavesTheLiveTableAlone) {
  SimulatedStorage good;
  ASSERT_EQ(ParameterStore(good).save(set_number(1)), StoreResult::kOk);
  FlakyStorage whole(good);
  EXPECT_EQ(load(whole).result, StoreResult::kOk);
  const std::size_t reads = whole.reads();
  ASSERT_GT(reads, kParamCount);
  for (const bool lies : {false, true}) {
    for (std::size_t n = 0; n < reads; ++n) {
      FlakyStorage flaky(good);
      flaky.good_reads = n;
      flaky.lies = lies;
      const Loaded l = load(flaky);
      // A slot that cannot be read may be the newer one, but the other is still a whole set.
      if (l.result == StoreResult::kOk) {
        ASSERT_TRUE(same(l.parameters, set_number(1))) << n;
      } else {
        ASSERT_TRUE(same(l.parameters, Parameters())) << n << (lies ? " lies" : " fails");
      }
      if (!lies && n == 0) {
        EXPECT_EQ(l.result, StoreResult::kFailed);  // nobody knows what is stored
      }
    }
  }
}

/// Counts what is done to a medium, and spoils what is written.
class WatchedStorage final : public hal::Storage {
 public:
  explicit WatchedStorage(hal::Storage& good) : good_{good} {}
  std::size_t size() const override { return good_.size(); }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override {
    read_bytes += count;
    return good_.read(offset, data, count);
  }
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override {
    ++writes;
    largest = std::max(largest, count);
    std::vector<std::uint8_t> bytes(data, data + count);
    if (writes == spoiled_write)
      bytes[count / 2] ^= 0x10u;  // reports success and stores something else
    return good_.write(offset, bytes.data(), count);
  }
  bool flush() override { return good_.flush(); }

  std::size_t writes{0};
  std::size_t largest{0};
  std::size_t read_bytes{0};
  std::size_t spoiled_write{~std::size_t{0}};

 private:
  hal::Storage& good_;
};

TEST(ParameterStore, AStepWritesOneBlockAndReadsBackNoMore) {
  SimulatedStorage medium;
  ASSERT_EQ(ParameterStore(medium).save(set_number(1)), StoreResult::kOk);
  WatchedStorage storage(medium);
  ParameterStore store(storage);
  Parameters p;
  ParameterStore::LoadReport report;
  ASSERT_EQ(store.load(p, report), StoreResult::kOk);
  ASSERT_EQ(p.set_int(Param::kSysId, 9), SetResult::kChanged);
  storage.read_bytes = 0;
  ASSERT_EQ(store.begin(p), StoreResult::kBusy);
  EXPECT_EQ(storage.read_bytes, 0u);  // loading found out all that it needs
  StoreResult result = StoreResult::kBusy;
  std::size_t steps = 0;
  while (result == StoreResult::kBusy) {
    EXPECT_TRUE(store.busy());
    const std::size_t writes = storage.writes;
    const std::size_t read = storage.read_bytes;
    result = store.step(p);
    EXPECT_EQ(storage.writes, writes + 1);
    EXPECT_LE(storage.read_bytes - read, ParameterStore::kBlockBytes);
    ASSERT_LT(++steps, 130u);
  }
  EXPECT_EQ(result, StoreResult::kOk);
  EXPECT_FALSE(store.busy());
  EXPECT_LE(storage.largest, ParameterStore::kBlockBytes);
  EXPECT_TRUE(p.unsaved());
  store.mark_saved(p);
  EXPECT_FALSE(p.unsaved());
  EXPECT_EQ(load(medium).parameters.get_int(Param::kSysId), 9);
}

TEST(ParameterStore, WhatChangesDuringASaveStaysUnsavedAndNoValueIsTorn) {
  SimulatedStorage storage;
  ParameterStore store(storage);
  Parameters p;
  ASSERT_EQ(store.begin(p), StoreResult::kBusy);
  StoreResult result = StoreResult::kBusy;
  for (int n = 1; result == StoreResult::kBusy; ++n) {
    result = store.step(p);
    for (std::size_t k = 0; k < 200; ++k) {  // each step another value with other bytes everywhere
      const auto id = static_cast<Param>(static_cast<std::size_t>(Param::kPriMixer0_0) + k);
      static_cast<void>(p.set_bits(id, kFloatCode, n % 2 == 0 ? 0x11111111u : 0x22222222u, false));
    }
  }
  ASSERT_EQ(result, StoreResult::kOk);
  store.mark_saved(p);
  EXPECT_TRUE(p.unsaved());
  const Loaded l = load(storage);
  ASSERT_EQ(l.result, StoreResult::kOk);
  for (std::size_t k = 0; k < 200; ++k) {
    const auto id = static_cast<Param>(static_cast<std::size_t>(Param::kPriMixer0_0) + k);
    const std::uint32_t bits = l.parameters.bits(id);
    EXPECT_TRUE(bits == Parameters().bits(id) || bits == 0x11111111u || bits == 0x22222222u);
  }
}

TEST(ParameterStore, AWriteThatDoesNotReadBackFailsAndTheOldSetStands) {
  const auto saved = [](std::size_t spoiled, SimulatedStorage& medium) {
    EXPECT_EQ(ParameterStore(medium).save(set_number(1)), StoreResult::kOk);
    WatchedStorage storage(medium);
    storage.spoiled_write = spoiled;
    const StoreResult result = ParameterStore(storage).save(set_number(2));
    return std::pair{result, storage.writes};
  };
  SimulatedStorage whole;
  const std::size_t writes = saved(~std::size_t{0}, whole).second;
  ASSERT_GT(writes, 100u);
  for (std::size_t n = 1; n <= writes; ++n) {
    SimulatedStorage medium;
    const auto [result, done] = saved(n, medium);
    EXPECT_EQ(result, StoreResult::kFailed) << n;
    EXPECT_EQ(done, n);
    EXPECT_TRUE(same(load(medium).parameters, set_number(1))) << n;
  }
}

TEST(ParameterStore, AWatchdogIsFedBetweenTheBlocks) {
  SimulatedStorage storage;
  boards::SimulatedSystem system;
  ASSERT_EQ(ParameterStore(storage).save(set_number(1), &system), StoreResult::kOk);
  EXPECT_GT(system.passes(), 100u);
}

TEST(ParameterStore, ASlotThatCannotBeReadIsNeverWrittenOverTheOther) {
  SimulatedStorage medium;
  ASSERT_EQ(ParameterStore(medium).save(set_number(1)), StoreResult::kOk);
  const auto before = medium.bytes();
  FlakyStorage deaf(medium);
  deaf.good_reads = 0;
  EXPECT_EQ(ParameterStore(deaf).save(set_number(2)), StoreResult::kFailed);
  EXPECT_EQ(medium.bytes(), before);
}

// ---- the record of gyro biases

/// Values of a set with these biases.
Parameters with_biases(float x, float y, float z) {
  Parameters p = set_number(5);
  static_cast<void>(p.set_float(Param::kGyroXBias, x));
  static_cast<void>(p.set_float(Param::kGyroYBias, y));
  static_cast<void>(p.set_float(Param::kGyroZBias, z));
  return p;
}

TEST(ParameterStore, AGyroCalibrationCostsOneBlock) {
  SimulatedStorage medium;
  WatchedStorage storage(medium);
  ParameterStore store(storage);
  Parameters p = with_biases(0.01f, 0.02f, 0.03f);
  EXPECT_EQ(store.save_gyro_bias(p), StoreResult::kFailed);  // no set that it could belong to
  ASSERT_EQ(store.save(p), StoreResult::kOk);
  store.mark_saved(p);
  for (const float x : {0.011f, 0.012f}) {
    ASSERT_EQ(p.set_float(Param::kGyroXBias, x), SetResult::kChanged);
    EXPECT_TRUE(p.unsaved());
    EXPECT_FALSE(p.others_unsaved());
    const std::size_t writes = storage.writes;
    ASSERT_EQ(store.save_gyro_bias(p), StoreResult::kOk);
    store.mark_saved(p);
    EXPECT_EQ(storage.writes, writes + 1);
    EXPECT_FALSE(p.unsaved());
    EXPECT_TRUE(same(load(medium).parameters, p));
    EXPECT_FALSE(load(medium).parameters.unsaved());
  }
  // The next whole set stands for itself.
  ASSERT_EQ(p.set_float(Param::kGyroXBias, 0.5f), SetResult::kChanged);
  ASSERT_EQ(store.save(p), StoreResult::kOk);
  EXPECT_TRUE(same(load(medium).parameters, p));
}

TEST(ParameterStore, ADamagedGyroRecordIsToldAndTheBiasesOfTheSetAreInForce) {
  SimulatedStorage storage;
  ParameterStore store(storage);
  const Parameters first = with_biases(0.01f, 0.02f, 0.03f);
  const Parameters second = with_biases(0.04f, 0.05f, 0.06f);
  ASSERT_EQ(store.save(first), StoreResult::kOk);
  ASSERT_EQ(store.save_gyro_bias(second), StoreResult::kOk);
  ASSERT_TRUE(same(load(storage).parameters, second));
  const auto intact = storage.bytes();
  const std::size_t record = storage.size() / 2 - 64;
  for (std::size_t k = 0; k < 24; ++k) {
    auto bytes = intact;
    bytes[record + k] ^= static_cast<std::uint8_t>(1u << (k % 8));
    storage.set_bytes(bytes);
    const Loaded l = load(storage);
    EXPECT_EQ(l.result, StoreResult::kOk);
    EXPECT_TRUE(l.report.fell_back) << "byte " << k;
    EXPECT_TRUE(same(l.parameters, first)) << k;
  }
  // A power cut while it is written leaves the biases of the set.
  for (std::size_t cut = 0; cut < 24; ++cut) {
    storage.set_bytes(intact);
    storage.cut_power_after(cut);
    ParameterStore other(storage);
    Parameters p;
    ParameterStore::LoadReport report;
    ASSERT_EQ(other.load(p, report), StoreResult::kOk);
    EXPECT_EQ(other.save_gyro_bias(with_biases(0.07f, 0.08f, 0.09f)), StoreResult::kFailed);
    storage.restore_power();
    const Parameters after = load(storage).parameters;
    EXPECT_TRUE(same(after, first) || same(after, second)) << cut;
  }
}

TEST(ParameterStore, ABlankSlotBesideTheSecondSetIsALossBesideTheFirstItIsNone) {
  SimulatedStorage storage;
  ParameterStore store(storage);
  ASSERT_EQ(store.save(with_biases(0.01f, 0.0f, 0.0f)), StoreResult::kOk);
  EXPECT_FALSE(load(storage).report.fell_back) << "nothing was ever in the other";
  ASSERT_EQ(store.save(with_biases(0.02f, 0.0f, 0.0f)), StoreResult::kOk);
  ASSERT_EQ(store.save(with_biases(0.03f, 0.0f, 0.0f)), StoreResult::kOk);
  const auto intact = storage.bytes();
  ASSERT_FALSE(load(storage).report.fell_back);
  for (const int erased : {0x00, 0xFF}) {
    for (const bool second : {false, true}) {
      auto bytes = intact;
      const auto half = static_cast<std::ptrdiff_t>(bytes.size() / 2);
      std::fill_n(bytes.begin() + (second ? half : 0), half, static_cast<std::uint8_t>(erased));
      storage.set_bytes(bytes);
      const Loaded l = load(storage);
      EXPECT_EQ(l.result, StoreResult::kOk);
      EXPECT_TRUE(l.report.fell_back) << erased << " " << second;
    }
  }
}

/// After a restart in the air each millisecond of reading counts: the set in force is read once, the one
/// before it not at all, and of the blank slot beside a first set only the bytes of a set.
TEST(ParameterStore, ALoadReadsTheSetInForceOnceAndTheOneBeforeItNotAtAll) {
  SimulatedStorage medium;
  constexpr std::size_t kHeadersAndRecord = 2 * kHeader + 24;
  for (int n = 1; n <= 4; ++n) {
    ASSERT_EQ(ParameterStore(medium).save(set_number(n)), StoreResult::kOk);
    WatchedStorage storage(medium);
    const Loaded l = load(storage);
    ASSERT_EQ(l.result, StoreResult::kOk);
    EXPECT_TRUE(same(l.parameters, set_number(n))) << n;
    const std::size_t once = ParameterStore::kSetBytes - kHeader + kHeadersAndRecord;
    const std::size_t blank = ParameterStore::kSlotBytes - kHeader;
    EXPECT_EQ(storage.read_bytes, n == 1 ? once + blank : once) << n;
  }
}

TEST(ParameterStore, ABlankSlotBesideASetIsReadWhereASetWouldBe) {
  SimulatedStorage storage;
  ASSERT_EQ(ParameterStore(storage).save(with_biases(0.01f, 0.0f, 0.0f)), StoreResult::kOk);
  const auto intact = storage.bytes();
  const std::size_t half = intact.size() / 2;
  const auto fell_back_with = [&](std::size_t at) {
    auto bytes = intact;
    bytes[half + at] ^= 0x55u;
    storage.set_bytes(bytes);
    const Loaded l = load(storage);
    EXPECT_EQ(l.result, StoreResult::kOk) << at;
    return l.report.fell_back;
  };
  for (const std::size_t at : {std::size_t{0}, std::size_t{12}, ParameterStore::kSetBytes - 1,
                               half - ParameterStore::kBlockBytes, half - 1}) {
    EXPECT_TRUE(fell_back_with(at)) << at << ": a newer set may have been there";
  }
  EXPECT_FALSE(fell_back_with(ParameterStore::kSetBytes)) << "no set was ever there";
}

TEST(ParameterStore, AGyroRecordOutOfRangeIsIgnored) {
  SimulatedStorage storage;
  ParameterStore store(storage);
  const Parameters first = with_biases(0.01f, 0.02f, 0.03f);
  ASSERT_EQ(store.save(first), StoreResult::kOk);
  for (const std::uint32_t bits : {0x7FC00000u, 0x7F800000u, float_bits(2.0f)}) {
    std::vector<std::uint8_t> record;
    put_u32(record, 0x31474652u);
    put_u32(record, 1);
    put_u32(record, float_bits(0.5f));
    put_u32(record, bits);
    put_u32(record, float_bits(0.5f));
    Crc32 crc;
    crc.add(record.data(), record.size());
    put_u32(record, crc.value());
    auto bytes = storage.bytes();
    std::copy(record.begin(), record.end(),
              bytes.begin() + static_cast<std::ptrdiff_t>(storage.size() / 2 - 64));
    storage.set_bytes(bytes);
    EXPECT_TRUE(same(load(storage).parameters, first));
  }
}

TEST(ParameterStore, WhatTheBarometerMeasuresAtEveryStartIsNoReasonToSave) {
  Parameters p;
  p.mark_saved(p.version());
  ASSERT_EQ(p.set_float(Param::kBaroBias, 90000.0f), SetResult::kChanged);
  ASSERT_EQ(p.set_float(Param::kGroundLevel, 700.0f), SetResult::kChanged);
  EXPECT_FALSE(p.unsaved());
  ASSERT_EQ(p.set_float(Param::kDiffPressBias, 1.0f), SetResult::kChanged);
  EXPECT_TRUE(p.unsaved());
}

TEST(ParameterStore, TheLayoutIsTheDocumentedOne) {
  SimulatedStorage storage;
  Parameters p;
  ASSERT_EQ(p.set_int(Param::kBaudRate, 0x000E1000), SetResult::kUnchanged);  // 921600
  ASSERT_EQ(ParameterStore(storage).save(p), StoreResult::kOk);
  const auto& b = storage.bytes();
  EXPECT_EQ(std::string(b.begin(), b.begin() + 4), "RFP1");
  EXPECT_EQ(b[4], 1u);  // sequence
  EXPECT_EQ(static_cast<std::size_t>(b[8] + 256 * b[9]), kParamCount);
  EXPECT_EQ(std::string(b.begin() + kHeader, b.begin() + kHeader + 9), "BAUD_RATE");
  EXPECT_EQ(b[kHeader + 15], 0u);
  EXPECT_EQ(b[kHeader + 16], 6u);
  EXPECT_EQ(b[kHeader + 17], 0x00u);
  EXPECT_EQ(b[kHeader + 18], 0x10u);
  EXPECT_EQ(b[kHeader + 19], 0x0Eu);
  EXPECT_EQ(b[kHeader + 20], 0x00u);
  EXPECT_EQ(ParameterStore::kSetBytes, 12u + kParamCount * 21u + 4u);
  const std::size_t record = storage.size() / 2 - 64;
  EXPECT_EQ(std::string(b.begin() + static_cast<std::ptrdiff_t>(record),
                        b.begin() + static_cast<std::ptrdiff_t>(record) + 4),
            "RFG1");
  EXPECT_EQ(b[record + 4], 1u);  // the sequence of its set
}

}  // namespace
}  // namespace rosflight::core
