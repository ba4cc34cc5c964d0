// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/parameter_store.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "firmware/boards/simulated/simulated_board.hpp"
#include "firmware/core/checksum.hpp"

namespace rosflight::core {
namespace {

using boards::SimulatedStorage;

constexpr std::size_t kHeader = 12;

void put_u32(std::vector<std::uint8_t>& out, std::uint32_t v) {
  for (int k = 0; k < 4; ++k) out.push_back(static_cast<std::uint8_t>(v >> (8 * k)));
}

struct Entry {
  std::string name;
  std::uint8_t type;
  std::uint32_t bits;
};

/// A slot as some other firmware could have written it.
std::vector<std::uint8_t> slot_of(std::uint32_t sequence, const std::vector<Entry>& entries) {
  std::vector<std::uint8_t> out;
  put_u32(out, 0x31504652u);
  put_u32(out, sequence);
  put_u32(out, static_cast<std::uint32_t>(entries.size()));
  for (const Entry& e : entries) {
    const link::ParamName name = padded_name(e.name.c_str());
    out.insert(out.end(), name.begin(), name.end());
    out.push_back(e.type);
    put_u32(out, e.bits);
  }
  Crc32 crc;
  crc.add(out.data(), out.size());
  put_u32(out, crc.value());
  return out;
}

void place(SimulatedStorage& storage, int slot, const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint8_t> all = storage.bytes();
  const std::size_t start = slot == 0 ? 0 : all.size() / 2;
  std::copy(bytes.begin(), bytes.end(), all.begin() + static_cast<std::ptrdiff_t>(start));
  storage.set_bytes(std::move(all));
}

std::uint32_t float_bits(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

bool same(const Parameters& a, const Parameters& b) {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    if (a.bits(static_cast<Param>(k)) != b.bits(static_cast<Param>(k))) return false;
  }
  return true;
}

/// A set that differs from another number's in many places.
Parameters set_number(int n) {
  Parameters p;
  static_cast<void>(p.set_int(Param::kSysId, n));
  for (std::size_t k = 0; k < 100; ++k) {
    const auto id = static_cast<Param>(static_cast<std::size_t>(Param::kPriMixer0_0) + k);
    static_cast<void>(p.set_float(id, static_cast<float>(n) + static_cast<float>(k) * 0.01f));
  }
  static_cast<void>(p.set_float(Param::kBattVoltLpf, 0.5f + 0.001f * static_cast<float>(n)));
  return p;
}

struct Loaded {
  StoreResult result;
  Parameters parameters;
  ParameterStore::LoadReport report;
};

Loaded load(hal::Storage& storage) {
  Loaded l{};
  l.result = ParameterStore(storage).load(l.parameters, l.report);
  return l;
}

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
  for (const unsigned fill : {0x00u, 0xFFu, 0xA5u}) {
    SimulatedStorage storage;
    storage.set_bytes(std::vector<std::uint8_t>(16384, static_cast<std::uint8_t>(fill)));
    EXPECT_EQ(load(storage).result, StoreResult::kBlank);
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
  for (std::size_t cut = 0; cut <= ParameterStore::kSlotBytes; ++cut) {
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
  EXPECT_EQ(old_sets, ParameterStore::kSlotBytes);
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
  for (std::size_t k = 0; k < ParameterStore::kSlotBytes; ++k) {
    if (k == 10 || k == 11) continue;  // reserved; part of the checksum, tested below
    std::vector<std::uint8_t> bytes = intact;
    bytes[start + k] ^= static_cast<std::uint8_t>(1u << (k % 8));
    storage.set_bytes(bytes);
    const Loaded l = load(storage);
    ASSERT_EQ(l.result, StoreResult::kOk) << k;
    ASSERT_TRUE(same(l.parameters, older)) << k;
  }
}

TEST(ParameterStore, TheReservedBytesAreCheckedToo) {
  SimulatedStorage storage;
  ASSERT_EQ(ParameterStore(storage).save(set_number(1)), StoreResult::kOk);
  for (const std::size_t k : {10u, 11u}) {
    std::vector<std::uint8_t> bytes = storage.bytes();
    bytes[k] ^= 1u;
    SimulatedStorage damaged;
    damaged.set_bytes(bytes);
    EXPECT_EQ(load(damaged).result, StoreResult::kBlank);
  }
}

TEST(ParameterStore, ACountBeyondTheSlotIsNoSet) {
  SimulatedStorage storage;
  std::vector<std::uint8_t> slot = slot_of(1, {});
  slot[8] = 0xFF;
  slot[9] = 0xFF;
  place(storage, 0, slot);
  EXPECT_EQ(load(storage).result, StoreResult::kBlank);
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
  p.mark_saved();
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

TEST(ParameterStore, TheLayoutIsTheDocumentedOne) {
  SimulatedStorage storage;
  Parameters p;
  ASSERT_EQ(p.set_int(Param::kBaudRate, 0x000E1000), SetResult::kUnchanged);  // 921600
  ASSERT_EQ(ParameterStore(storage).save(p), StoreResult::kOk);
  const auto& b = storage.bytes();
  EXPECT_EQ(std::string(b.begin(), b.begin() + 4), "RFP1");
  EXPECT_EQ(b[4], 1u);  // sequence
  EXPECT_EQ(b[8] + 256 * b[9], 333);
  EXPECT_EQ(std::string(b.begin() + kHeader, b.begin() + kHeader + 9), "BAUD_RATE");
  EXPECT_EQ(b[kHeader + 15], 0u);
  EXPECT_EQ(b[kHeader + 16], 6u);
  EXPECT_EQ(b[kHeader + 17], 0x00u);
  EXPECT_EQ(b[kHeader + 18], 0x10u);
  EXPECT_EQ(b[kHeader + 19], 0x0Eu);
  EXPECT_EQ(b[kHeader + 20], 0x00u);
  EXPECT_EQ(ParameterStore::kSlotBytes, 12u + 333u * 21u + 4u);
}

}  // namespace
}  // namespace rosflight::core
