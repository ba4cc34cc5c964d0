// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/parameter_store_rig.hpp"

namespace rosflight::core {
namespace {

TEST(ParameterStore, ReadsBackWhatItWrote) {
  SimulatedStorage storage;
  const Parameters written = set_number(3);
  ASSERT_EQ(ParameterStore(storage).save(written), StoreResult::kOk);
  const Loaded l = load(storage);
  EXPECT_EQ(l.result, StoreResult::kOk);
  EXPECT_TRUE(same(l.parameters, written));
  EXPECT_EQ(l.report.loaded, kParamCount);
  EXPECT_EQ(l.report.skipped, 0u);
  EXPECT_FALSE(l.parameters.unsaved());
}

TEST(ParameterStore, BlankMediaHoldNothing) {
  for (const unsigned fill : {0x00u, 0xFFu}) {
    SimulatedStorage storage;
    storage.set_bytes(std::vector<std::uint8_t>(16384, static_cast<std::uint8_t>(fill)));
    EXPECT_EQ(load(storage).result, StoreResult::kBlank);
  }
}

TEST(ParameterStore, AnythingElseThanAnErasedMediumIsDamage) {
  for (const unsigned fill : {0xA5u, 0x01u, 0xFEu}) {
    SimulatedStorage storage;
    storage.set_bytes(std::vector<std::uint8_t>(16384, static_cast<std::uint8_t>(fill)));
    EXPECT_EQ(load(storage).result, StoreResult::kDamaged);
  }
  for (const std::size_t place : {0u, 13u, 8191u, 8192u, 16383u}) {  // one byte of an erased one
    SimulatedStorage storage;
    auto bytes = storage.bytes();
    bytes[place] = 0x00;
    storage.set_bytes(bytes);
    EXPECT_EQ(load(storage).result, StoreResult::kDamaged) << place;
  }
}

TEST(ParameterStore, TheLatestOfManySavesIsInForce) {
  SimulatedStorage storage;
  for (int n = 1; n <= 5; ++n) {
    ASSERT_EQ(ParameterStore(storage).save(set_number(n)), StoreResult::kOk);
    const Loaded l = load(storage);
    EXPECT_EQ(l.result, StoreResult::kOk);
    EXPECT_TRUE(same(l.parameters, set_number(n))) << n;
  }
}

TEST(ParameterStore, SavesAlternateBetweenTheSlots) {
  SimulatedStorage storage;
  const auto half = static_cast<std::ptrdiff_t>(storage.size() / 2);
  const auto slot = [&](int k) {
    const auto& b = storage.bytes();
    return std::vector<std::uint8_t>(b.begin() + k * half, b.begin() + (k + 1) * half);
  };
  ASSERT_EQ(ParameterStore(storage).save(set_number(1)), StoreResult::kOk);
  const auto first = slot(0);
  ASSERT_EQ(ParameterStore(storage).save(set_number(2)), StoreResult::kOk);
  EXPECT_EQ(slot(0), first);
  const auto second = slot(1);
  ASSERT_EQ(ParameterStore(storage).save(set_number(3)), StoreResult::kOk);
  EXPECT_EQ(slot(1), second);
  EXPECT_NE(slot(0), first);
}

TEST(ParameterStore, TheSequenceNumberMayWrap) {
  SimulatedStorage storage;
  place(storage, 0, slot_of(0xFFFFFFFFu, {{"SYS_ID", 6, 8}}));
  place(storage, 1, slot_of(0, {{"SYS_ID", 6, 9}}));
  EXPECT_EQ(load(storage).parameters.get_int(Param::kSysId), 9);
  ASSERT_EQ(ParameterStore(storage).save(set_number(4)),
            StoreResult::kOk);  // over the older: slot 0
  EXPECT_EQ(load(storage).parameters.get_int(Param::kSysId), 4);
}

/// Bytes of one save: the record of gyro biases, then the set.
constexpr std::size_t kWritten = 24 + ParameterStore::kSetBytes;

/// Cuts the power after every possible number of bytes of one save.
void cut_everywhere(int saves_before) {
  SimulatedStorage storage;
  for (int n = 1; n <= saves_before; ++n) {
    ASSERT_EQ(ParameterStore(storage).save(set_number(n)), StoreResult::kOk);
  }
  const std::vector<std::uint8_t> before = storage.bytes();
  const Parameters older = set_number(saves_before);
  const Parameters newer = set_number(saves_before + 1);
  std::size_t old_sets = 0;
  std::size_t new_sets = 0;
  for (std::size_t cut = 0; cut <= kWritten; ++cut) {
    storage.set_bytes(before);
    storage.cut_power_after(cut);
    const StoreResult result = ParameterStore(storage).save(newer);
    storage.restore_power();
    const Loaded l = load(storage);
    if (saves_before > 0) {
      ASSERT_EQ(l.result, StoreResult::kOk) << "cut after " << cut;
    }
    if (l.result == StoreResult::kOk && same(l.parameters, newer)) {
      ++new_sets;
    } else {
      ASSERT_TRUE(same(l.parameters, saves_before > 0 ? older : Parameters()))
          << "cut after " << cut;
      ASSERT_EQ(result, StoreResult::kFailed) << "cut after " << cut;
      ++old_sets;
    }
    // And the next save works, whatever the cut left behind.
    if (cut % 500 == 0) {
      ASSERT_EQ(ParameterStore(storage).save(newer), StoreResult::kOk);
      ASSERT_TRUE(same(load(storage).parameters, newer));
    }
  }
  EXPECT_EQ(new_sets, 1u);  // only the last byte of the checksum makes the set the new one
  EXPECT_EQ(old_sets, kWritten);
}

TEST(ParameterStore, ACutAtEveryByteOfTheFirstSaveLeavesNothingOrTheWholeSet) {
  cut_everywhere(0);
}
TEST(ParameterStore, ACutAtEveryByteIntoTheSecondSlotLeavesTheOldOrTheNewSet) {
  cut_everywhere(1);
}
TEST(ParameterStore, ACutAtEveryByteIntoTheFirstSlotLeavesTheOldOrTheNewSet) {
  cut_everywhere(2);
}

TEST(ParameterStore, ACorruptedByteAnywhereFallsBackToTheOlderSet) {
  SimulatedStorage storage;
  ASSERT_EQ(ParameterStore(storage).save(set_number(1)), StoreResult::kOk);
  ASSERT_EQ(ParameterStore(storage).save(set_number(2)), StoreResult::kOk);
  const std::vector<std::uint8_t> intact = storage.bytes();
  const std::size_t start = intact.size() / 2;
  const Parameters older = set_number(1);
  for (std::size_t k = 0; k < ParameterStore::kSetBytes; ++k) {
    if (k == 10 || k == 11) continue;  // reserved; part of the checksum, tested below
    std::vector<std::uint8_t> bytes = intact;
    bytes[start + k] ^= static_cast<std::uint8_t>(1u << (k % 8));
    storage.set_bytes(bytes);
    const Loaded l = load(storage);
    ASSERT_EQ(l.result, StoreResult::kOk) << k;
    ASSERT_TRUE(same(l.parameters, older)) << k;
    ASSERT_EQ(l.report.loaded, kParamCount) << k;
    ASSERT_EQ(l.report.skipped, 0u) << k;
  }
}

TEST(ParameterStore, NothingOfADamagedSetIsTakenOver) {
  SimulatedStorage storage;
  place(storage, 0, slot_of(1, {{"SYS_ID", 6, 7}}));
  std::vector<std::uint8_t> damaged = slot_of(2, {{"SYS_ID", 6, 8}, {"NUM_MOTORS", 6, 6}});
  damaged.back() ^= 1u;
  place(storage, 1, damaged);
  const Loaded l = load(storage);
  ASSERT_EQ(l.result, StoreResult::kOk);
  EXPECT_TRUE(l.report.fell_back);
  EXPECT_EQ(l.report.loaded, 1u);
  EXPECT_EQ(l.parameters.get_int(Param::kSysId), 7);
  EXPECT_EQ(l.parameters.get_int(Param::kNumMotors), 4) << "only the damaged set names it";
}

TEST(ParameterStore, FallingBackToTheOlderSetIsReported) {
  SimulatedStorage storage;
  ASSERT_EQ(ParameterStore(storage).save(set_number(1)), StoreResult::kOk);
  EXPECT_FALSE(load(storage).report.fell_back);  // the other slot is blank
  ASSERT_EQ(ParameterStore(storage).save(set_number(2)), StoreResult::kOk);
  EXPECT_FALSE(load(storage).report.fell_back);
  const std::vector<std::uint8_t> intact = storage.bytes();
  const std::size_t half = intact.size() / 2;
  for (const std::size_t k : {std::size_t{0}, std::size_t{4}, std::size_t{7}, std::size_t{8},
                              std::size_t{100}, ParameterStore::kSetBytes - 1}) {
    for (const std::size_t slot : {std::size_t{0}, std::size_t{1}}) {
      std::vector<std::uint8_t> bytes = intact;
      bytes[slot * half + k] ^= 0x80u;
      storage.set_bytes(bytes);
      const Loaded l = load(storage);
      ASSERT_EQ(l.result, StoreResult::kOk);
      EXPECT_TRUE(same(l.parameters, set_number(slot == 1 ? 1 : 2)));
      // A damaged older set is reported only if nobody can tell that it is the older one.
      EXPECT_EQ(l.report.fell_back, slot == 1 || k < 8) << slot << ' ' << k;
    }
  }
}

TEST(ParameterStore, ASaveThatWasCutOffIsReportedToo) {
  SimulatedStorage storage;
  ASSERT_EQ(ParameterStore(storage).save(set_number(1)), StoreResult::kOk);
  storage.cut_power_after(500);
  ASSERT_EQ(ParameterStore(storage).save(set_number(2)), StoreResult::kFailed);
  storage.restore_power();
  EXPECT_TRUE(load(storage).report.fell_back);
  ASSERT_EQ(ParameterStore(storage).save(set_number(2)), StoreResult::kOk);
  EXPECT_FALSE(load(storage).report.fell_back);
}

TEST(ParameterStore, TheReservedBytesAreCheckedToo) {
  SimulatedStorage storage;
  ASSERT_EQ(ParameterStore(storage).save(set_number(1)), StoreResult::kOk);
  for (const std::size_t k : {10u, 11u}) {
    std::vector<std::uint8_t> bytes = storage.bytes();
    bytes[k] ^= 1u;
    SimulatedStorage damaged;
    damaged.set_bytes(bytes);
    EXPECT_EQ(load(damaged).result, StoreResult::kDamaged);
  }
}

TEST(ParameterStore, ACountBeyondTheSlotIsNoSet) {
  SimulatedStorage storage;
  std::vector<std::uint8_t> slot = slot_of(1, {});
  slot[8] = 0xFF;
  slot[9] = 0xFF;
  place(storage, 0, slot);
  EXPECT_EQ(load(storage).result, StoreResult::kDamaged);
}

TEST(ParameterStore, UnknownNamesOtherTypesAndBadValuesAreSkippedAndCounted) {
  SimulatedStorage storage;
  place(storage, 0,
        slot_of(1, {{"SYS_ID", 6, 7},
                    {"GONE_PARAMETER", 6, 1},
                    {"PID_TAU", 6, 1},                          // was an integer once
                    {"NUM_MOTORS", 6, 99},                      // out of range
                    {"PID_ROLL_RATE_P", 9, 0x7FC00000u},        // NaN
                    {"RC_ARM_THRESHOLD", 9, float_bits(0.2f)},  // sixteen characters
                    {"FAILSAFE_THR", 9, float_bits(0.4f)}}));
  const Loaded l = load(storage);
  ASSERT_EQ(l.result, StoreResult::kOk);
  EXPECT_EQ(l.report.loaded, 3u);
  EXPECT_EQ(l.report.skipped, 4u);
  EXPECT_EQ(l.report.first_skipped, padded_name("GONE_PARAMETER"));
  EXPECT_EQ(l.parameters.get_int(Param::kSysId), 7);
  EXPECT_EQ(l.parameters.get_float(Param::kRcArmThreshold), 0.2f);
  EXPECT_EQ(l.parameters.get_float(Param::kFailsafeThr), 0.4f);
  EXPECT_EQ(l.parameters.get_int(Param::kNumMotors), 4);
  EXPECT_EQ(l.parameters.get_float(Param::kPidTau), 0.05f);
}

TEST(ParameterStore, NamesThatStorageLacksKeepTheirValuesAndStayUnsaved) {
  SimulatedStorage storage;
  place(storage, 0, slot_of(1, {{"SYS_ID", 6, 7}}));
  Parameters p;
  p.mark_saved(p.version());
  ASSERT_EQ(p.set_int(Param::kNumMotors, 6), SetResult::kChanged);
  ParameterStore::LoadReport report;
  ASSERT_EQ(ParameterStore(storage).load(p, report), StoreResult::kOk);
  EXPECT_EQ(p.get_int(Param::kNumMotors), 6);
  EXPECT_TRUE(p.unsaved());  // storage does not hold NUM_MOTORS: arming must still save it
}

TEST(ParameterStore, OrderInStorageDoesNotMatter) {
  SimulatedStorage storage;
  place(storage, 1, slot_of(9, {{"BATT_CURR_LPF", 9, float_bits(0.25f)}, {"BAUD_RATE", 6, 57600}}));
  const Loaded l = load(storage);
  EXPECT_EQ(l.parameters.get_int(Param::kBaudRate), 57600);
  EXPECT_EQ(l.parameters.get_float(Param::kBattCurrLpf), 0.25f);
}

TEST(ParameterStore, LoadingMarksWhatDiffersAsChanged) {
  SimulatedStorage storage;
  place(storage, 0, slot_of(1, {{"SYS_ID", 6, 7}, {"NUM_MOTORS", 6, 4}}));
  Parameters p;
  static_cast<void>(p.take_changes());
  ParameterStore::LoadReport report;
  ASSERT_EQ(ParameterStore(storage).load(p, report), StoreResult::kOk);
  const auto changes = p.take_changes();
  EXPECT_EQ(changes.count(), 1u);
  EXPECT_TRUE(changes.test(static_cast<std::size_t>(Param::kSysId)));
}

TEST(ParameterStore, ATooSmallMediumFailsAndIsNotTouched) {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{8}, std::size_t{40}, 2 * ParameterStore::kSlotBytes - 2}) {
    SimulatedStorage storage(size);
    const auto before = storage.bytes();
    EXPECT_EQ(ParameterStore(storage).save(Parameters()), StoreResult::kFailed) << size;
    EXPECT_EQ(storage.bytes(), before);
    EXPECT_NE(load(storage).result, StoreResult::kOk);
  }
  SimulatedStorage exact(2 * ParameterStore::kSlotBytes);
  ASSERT_EQ(ParameterStore(exact).save(set_number(1)), StoreResult::kOk);
  ASSERT_EQ(ParameterStore(exact).save(set_number(2)), StoreResult::kOk);
  EXPECT_TRUE(same(load(exact).parameters, set_number(2)));
}

}  // namespace
}  // namespace rosflight::core
