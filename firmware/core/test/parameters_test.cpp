// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace rosflight::core {
namespace {

constexpr std::uint8_t kIntCode = 6;    // MAV_PARAM_TYPE_INT32
constexpr std::uint8_t kFloatCode = 9;  // MAV_PARAM_TYPE_REAL32
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::uint32_t bits_of(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
std::uint32_t bits_of(std::int32_t value) {
  return static_cast<std::uint32_t>(value);
}
std::string name_of(std::size_t index) {
  const link::ParamName& name = Parameters::row(static_cast<Param>(index)).name;
  return {name.data(), strnlen(name.data(), name.size())};
}

struct ReferenceRow {
  std::string name, type, initial;
};

/// Names, types and defaults of ROSflight 2.0.1, in the order of the link.
std::vector<ReferenceRow> reference() {
  const char* path = "firmware/core/test/data/reference_parameters.csv";
  std::ifstream file(path);
  EXPECT_TRUE(file.is_open()) << path << ": run from the root of the project";
  std::vector<ReferenceRow> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    ReferenceRow row;
    std::getline(fields, row.name, ',');
    std::getline(fields, row.type, ',');
    std::getline(fields, row.initial, ',');
    rows.push_back(row);
  }
  return rows;
}

TEST(ParameterTable, HasNamesTypesDefaultsAndOrderOfTheReference) {
  const auto rows = reference();
  ASSERT_EQ(rows.size(), kReferenceParamCount);
  ASSERT_GE(kParamCount, kReferenceParamCount);  // ours follow
  const Parameters fresh;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    SCOPED_TRACE(rows[k].name);
    const auto id = static_cast<Param>(k);
    EXPECT_EQ(name_of(k), rows[k].name);
    if (rows[k].type == "int32") {
      EXPECT_EQ(Parameters::row(id).type, ParamType::kInt32);
      EXPECT_EQ(fresh.get_int(id), std::stoi(rows[k].initial));
    } else {
      ASSERT_EQ(rows[k].type, "float");
      EXPECT_EQ(Parameters::row(id).type, ParamType::kFloat);
      // A literal rounded once to single precision, so equal to the last bit.
      EXPECT_EQ(fresh.get_float(id), std::strtof(rows[k].initial.c_str(), nullptr));
    }
  }
}

TEST(ParameterTable, IndexRangesAreThoseOfTheReference) {
  const std::vector<std::pair<std::size_t, const char*>> anchors{
      {0, "BAUD_RATE"},         {1, "SERIAL_DEVICE"},      {11, "PRI_MIXER_OUT_0"},
      {20, "PRI_MIXER_OUT_9"},  {21, "PRI_MIXER_PWM_0"},   {30, "PRI_MIXER_PWM_9"},
      {31, "PRI_MIXER_0_0"},    {130, "PRI_MIXER_9_9"},    {131, "SEC_MIXER_0_0"},
      {230, "SEC_MIXER_9_9"},   {231, "SYS_ID"},           {315, "PRIMARY_MIXER"},
      {316, "SECONDARY_MIXER"}, {327, "RC_ARM_THRESHOLD"}, {328, "OFFBOARD_TIMEOUT"},
      {332, "BATT_CURR_LPF"}};
  for (const auto& [index, name] : anchors) EXPECT_EQ(name_of(index), name);
  for (std::size_t channel = 0; channel < 10; ++channel) {
    for (std::size_t input = 0; input < 10; ++input) {
      const std::string pair = std::to_string(input) + "_" + std::to_string(channel);
      EXPECT_EQ(name_of(31 + 10 * channel + input), "PRI_MIXER_" + pair);
      EXPECT_EQ(name_of(131 + 10 * channel + input), "SEC_MIXER_" + pair);
    }
  }
}

TEST(ParameterTable, EveryDefaultAndSentinelIsAccepted) {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    SCOPED_TRACE(name_of(k));
    const auto id = static_cast<Param>(k);
    const ParamRow& row = Parameters::row(id);
    EXPECT_TRUE(Parameters::in_range(id, row.initial));
    EXPECT_LE(row.min, row.max);
    Parameters p;
    if (row.type == ParamType::kFloat) {
      EXPECT_NE(p.set_float(id, row.sentinel), SetResult::kOutOfRange);
    } else {
      EXPECT_EQ(row.sentinel, std::floor(row.sentinel));
      EXPECT_NE(p.set_int(id, static_cast<std::int32_t>(row.sentinel)), SetResult::kOutOfRange);
    }
  }
}

TEST(ParameterTable, DocumentedSentinelsOfTheReferenceAreAccepted) {
  Parameters p;
  for (const Param id : {Param::kPrimaryMixer, Param::kSecondaryMixer}) {
    EXPECT_EQ(p.set_int(id, 11), SetResult::kChanged);
    EXPECT_EQ(p.set_int(id, 255), SetResult::kChanged);
    EXPECT_EQ(p.set_int(id, 254), SetResult::kOutOfRange);
    EXPECT_EQ(p.set_int(id, -1), SetResult::kOutOfRange);
  }
  for (const Param id :
       {Param::kRcAttOvrdChn, Param::kRcThrOvrdChn, Param::kRcAttCtrlChn, Param::kRcArmChn}) {
    EXPECT_NE(p.set_int(id, -1), SetResult::kOutOfRange);
    EXPECT_EQ(p.set_int(id, 5), SetResult::kChanged);
    EXPECT_EQ(p.set_int(id, 3), SetResult::kOutOfRange);
  }
  EXPECT_EQ(p.set_float(Param::kFailsafeThr, 0.4f), SetResult::kChanged);
  EXPECT_EQ(p.set_float(Param::kFailsafeThr, -1.0f), SetResult::kChanged);
  EXPECT_EQ(p.set_float(Param::kFailsafeThr, -0.5f), SetResult::kOutOfRange);
}

TEST(ParameterTable, LimitsThemselvesAreInside) {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    SCOPED_TRACE(name_of(k));
    const auto id = static_cast<Param>(k);
    const ParamRow& row = Parameters::row(id);
    if (row.type == ParamType::kInt32) {
      EXPECT_TRUE(Parameters::in_range(id, ParamValue{static_cast<std::int32_t>(row.min)}));
      EXPECT_TRUE(Parameters::in_range(id, ParamValue{static_cast<std::int32_t>(row.max)}));
      const auto above = static_cast<std::int32_t>(row.max) + 1;
      if (static_cast<float>(above) != row.sentinel) {
        EXPECT_FALSE(Parameters::in_range(id, ParamValue{above}));
      }
    } else if (std::isfinite(row.max)) {
      EXPECT_TRUE(Parameters::in_range(id, ParamValue{row.min}));
      EXPECT_TRUE(Parameters::in_range(id, ParamValue{row.max}));
      EXPECT_FALSE(Parameters::in_range(id, ParamValue{std::nextafter(row.max, kInf)}));
      const float below = std::nextafter(row.min, -kInf);
      if (below != row.sentinel) {
        EXPECT_FALSE(Parameters::in_range(id, ParamValue{below}));
      }
    }
  }
}

TEST(Parameters, WhatNoVehicleFliesWithIsOutOfRange) {
  for (const auto& [id, bad, good] :
       std::vector<std::tuple<Param, float, float>>{{Param::kGyroXyLpf, 1.0f, 0.99f},
                                                    {Param::kGyroZLpf, 1.0f, 0.99f},
                                                    {Param::kAccLpf, 1.0f, 0.99f},
                                                    {Param::kBattVoltLpf, 1.0f, 0.9999f},
                                                    {Param::kBattCurrLpf, 1.0f, 0.9999f},
                                                    {Param::kRcArmThreshold, 0.26f, 0.25f},
                                                    {Param::kRcArmThreshold, 0.0f, 0.01f},
                                                    {Param::kPidTau, 0.0f, 0.001f},
                                                    {Param::kMotorIdleThr, 1.0f, 0.5f}}) {
    Parameters p;
    EXPECT_EQ(p.set_float(id, bad), SetResult::kOutOfRange) << static_cast<int>(id);
    EXPECT_EQ(p.set_float(id, good), SetResult::kChanged) << static_cast<int>(id);
  }
}

TEST(Parameters, NotANumberAndInfinityAreRefusedEverywhere) {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    if (Parameters::row(id).type != ParamType::kFloat) continue;
    SCOPED_TRACE(name_of(k));
    Parameters p;
    const std::uint32_t before = p.bits(id);
    for (const float bad : {kNan, kInf, -kInf}) {
      EXPECT_EQ(p.set_bits(id, kFloatCode, bits_of(bad), false), SetResult::kOutOfRange);
      EXPECT_EQ(p.set_float(id, bad), SetResult::kOutOfRange);
    }
    EXPECT_EQ(p.bits(id), before);
  }
}

TEST(Parameters, LargeIntegersAreNotRoundedBeforeTheRangeCheck) {
  EXPECT_TRUE(Parameters::in_range(Param::kBaudRate, ParamValue{3'000'000}));
  EXPECT_FALSE(Parameters::in_range(Param::kBaudRate, ParamValue{3'000'001}));
  EXPECT_FALSE(
      Parameters::in_range(Param::kSysId, ParamValue{std::numeric_limits<std::int32_t>::max()}));
  EXPECT_FALSE(
      Parameters::in_range(Param::kSysId, ParamValue{std::numeric_limits<std::int32_t>::min()}));
}

TEST(Parameters, AWrongTypeCodeIsRefused) {
  Parameters p;
  EXPECT_EQ(p.set_bits(Param::kSysId, kFloatCode, bits_of(2), false), SetResult::kWrongType);
  EXPECT_EQ(p.set_bits(Param::kPidTau, kIntCode, bits_of(0.1f), false), SetResult::kWrongType);
  for (const int code : {0, 1, 2, 5, 7, 8, 10, 255}) {
    EXPECT_EQ(p.set_bits(Param::kSysId, static_cast<std::uint8_t>(code), bits_of(2), false),
              SetResult::kWrongType);
  }
  EXPECT_EQ(p.set_int(Param::kPidTau, 0), SetResult::kWrongType);
  EXPECT_EQ(p.set_float(Param::kSysId, 2.0f), SetResult::kWrongType);
  EXPECT_EQ(p.get_int(Param::kSysId), 1);
}

TEST(Parameters, DangerousOnesAreLockedWhileArmed) {
  Parameters p;
  EXPECT_EQ(p.set_bits(Param::kPrimaryMixer, kIntCode, bits_of(2), true), SetResult::kLockedArmed);
  EXPECT_EQ(p.get_int(Param::kPrimaryMixer), 255);
  // Asking for the value it has is no change, and out of range is worse than armed.
  EXPECT_EQ(p.set_bits(Param::kPrimaryMixer, kIntCode, bits_of(255), true), SetResult::kUnchanged);
  EXPECT_EQ(p.set_bits(Param::kPrimaryMixer, kIntCode, bits_of(99), true), SetResult::kOutOfRange);
  // Gains are tuned in flight, a mixer is not.
  EXPECT_EQ(p.set_bits(Param::kPidRollRateP, kFloatCode, bits_of(0.1f), true), SetResult::kChanged);
  EXPECT_EQ(p.set_bits(Param::kPriMixer3_0, kFloatCode, bits_of(0.1f), true),
            SetResult::kLockedArmed);
  EXPECT_EQ(p.set_bits(Param::kPrimaryMixer, kIntCode, bits_of(2), false), SetResult::kChanged);
}

TEST(Parameters, OnlyGainsTrimsAndTheLargestThrottleMayChangeWhileArmed) {
  std::set<std::string> open;
  for (std::size_t k = 0; k < kParamCount; ++k) {
    if (Parameters::armed_rule(static_cast<Param>(k)).factor != 0.0f) open.insert(name_of(k));
  }
  std::set<std::string> wanted{"X_EQ_TORQUE", "Y_EQ_TORQUE", "Z_EQ_TORQUE", "RC_MAX_THR"};
  for (const char* loop : {"ROLL_RATE", "PITCH_RATE", "YAW_RATE", "ROLL_ANG", "PITCH_ANG"}) {
    for (const char* term : {"P", "I", "D"}) {
      wanted.insert(std::string("PID_") + loop + "_" + term);
    }
  }
  EXPECT_EQ(open, wanted);
}

/// Values worth asking for, whatever the parameter: neighbours, limits, other signs, extremes.
std::vector<std::uint32_t> asked_for(const ParamRow& row, std::uint32_t now) {
  std::vector<std::uint32_t> bits;
  if (row.type == ParamType::kInt32) {
    const auto v = static_cast<std::int32_t>(now);
    for (const std::int32_t w :
         {v + 1, v - 1, -v, 0, 1, static_cast<std::int32_t>(row.min),
          static_cast<std::int32_t>(row.max), static_cast<std::int32_t>(row.sentinel)}) {
      bits.push_back(bits_of(w));
    }
    return bits;
  }
  float v = 0.0f;
  std::memcpy(&v, &now, sizeof v);
  for (const float w : {v * 1.1f, v / 1.1f, -v, 0.0f, -0.0f, v + 1e-6f, v - 1e-6f, v + 0.5f,
                        v - 0.5f, 1.0f, 0.02f, 1e-30f, 1e30f, row.min, row.max, row.sentinel}) {
    bits.push_back(bits_of(w));
  }
  return bits;
}

TEST(Parameters, WhileArmedNoLockedOneTakesAnyOtherValue) {
  std::size_t locked = 0;
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    const ParamRow& row = Parameters::row(id);
    if (Parameters::armed_rule(id).factor != 0.0f) continue;
    SCOPED_TRACE(name_of(k));
    ++locked;
    Parameters p;
    const std::uint32_t before = p.bits(id);
    for (const std::uint32_t bits : asked_for(row, before)) {
      const SetResult result = p.set_bits(id, static_cast<std::uint8_t>(row.type), bits, true);
      if (bits == before) {
        EXPECT_EQ(result, SetResult::kUnchanged);
      } else {
        EXPECT_TRUE(result == SetResult::kLockedArmed || result == SetResult::kOutOfRange);
      }
      EXPECT_EQ(p.bits(id), before);
    }
  }
  EXPECT_EQ(locked, kParamCount - 19);
}

TEST(Parameters, WhileArmedEachOpenOneKeepsToItsRule) {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    const ArmedRule& rule = Parameters::armed_rule(id);
    if (rule.factor == 0.0f) continue;
    SCOPED_TRACE(name_of(k));
    ASSERT_EQ(Parameters::row(id).type, ParamType::kFloat);
    const bool signs = Parameters::row(id).min < 0.0f;
    const auto ask = [id](float from, float to) {
      Parameters p;
      EXPECT_NE(p.set_float(id, from), SetResult::kOutOfRange);
      const SetResult result = p.set_bits(id, kFloatCode, bits_of(to), true);
      EXPECT_EQ(p.bits(id), bits_of(result == SetResult::kChanged ? to : from))
          << from << ' ' << to;
      return result;
    };
    for (const float bad : {kNan, kInf, -kInf}) EXPECT_EQ(ask(0.5f, bad), SetResult::kOutOfRange);
    const float from = 0.5f;
    const float most = std::min(from * rule.factor, Parameters::row(id).max);
    const float least = rule.only_up ? from : from / rule.factor;
    EXPECT_EQ(ask(from, most), SetResult::kChanged);
    EXPECT_EQ(ask(from, least), rule.only_up ? SetResult::kUnchanged : SetResult::kChanged);
    if (most < Parameters::row(id).max) {
      EXPECT_EQ(ask(from, std::nextafter(most, kInf)), SetResult::kTooFar);
    }
    EXPECT_EQ(ask(from, std::nextafter(least, -kInf)), SetResult::kTooFar);
    EXPECT_EQ(ask(from, 0.0f), SetResult::kTooFar);
    if (signs) {
      EXPECT_EQ(ask(from, -from), SetResult::kTooFar);
    }
    // Around zero: a step where there is one, else nothing gets to zero or away from it.
    const float tiny = 0.001f;
    EXPECT_EQ(ask(0.0f, 0.02f), rule.step > 0.0f ? SetResult::kChanged : SetResult::kTooFar);
    EXPECT_EQ(ask(0.02f, 0.0f), rule.step > 0.0f ? SetResult::kChanged : SetResult::kTooFar);
    EXPECT_EQ(ask(tiny, 0.02f), rule.step > 0.0f ? SetResult::kChanged : SetResult::kTooFar);
    EXPECT_EQ(ask(0.0f, 0.021f), SetResult::kTooFar);
    EXPECT_EQ(ask(tiny, 0.022f), SetResult::kTooFar);
    if (signs) {
      EXPECT_EQ(ask(0.01f, -0.01f), SetResult::kChanged);
      EXPECT_EQ(ask(0.011f, -0.011f), SetResult::kTooFar);
      EXPECT_EQ(ask(-0.5f, -2.0f), SetResult::kChanged);
      EXPECT_EQ(ask(-0.5f, -2.1f), SetResult::kTooFar);
    }
  }
}

TEST(Parameters, WhileArmedTheThrottleLimitOnlyRises) {
  Parameters p;  // 0.7
  for (const float lower : {0.69f, 0.5f, 0.3f, 0.0f}) {
    EXPECT_EQ(p.set_bits(Param::kRcMaxThr, kFloatCode, bits_of(lower), true), SetResult::kTooFar);
  }
  EXPECT_EQ(p.set_bits(Param::kRcMaxThr, kFloatCode, bits_of(1.0f), true), SetResult::kChanged);
  EXPECT_EQ(p.set_bits(Param::kRcMaxThr, kFloatCode, bits_of(0.7f), true), SetResult::kTooFar);
  EXPECT_EQ(p.set_bits(Param::kRcMaxThr, kFloatCode, bits_of(0.7f), false), SetResult::kChanged);
}

TEST(Parameters, SetsValuesBitForBit) {
  Parameters p;
  // Signed zeros occur in mixer files; what was set is what is stored and echoed.
  EXPECT_EQ(p.set_bits(Param::kPriMixer0_0, kFloatCode, bits_of(-0.0f), false),
            SetResult::kChanged);
  EXPECT_EQ(p.bits(Param::kPriMixer0_0), 0x80000000u);
  EXPECT_EQ(p.set_bits(Param::kPriMixer0_0, kFloatCode, bits_of(-0.0f), false),
            SetResult::kUnchanged);
  EXPECT_EQ(p.set_bits(Param::kPriMixer0_0, kFloatCode, 0u, false), SetResult::kChanged);
  EXPECT_EQ(p.bits(Param::kPriMixer0_0), 0u);
  const float tiny = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(p.set_bits(Param::kPriMixer0_0, kFloatCode, bits_of(tiny), false), SetResult::kChanged);
  EXPECT_EQ(p.get_float(Param::kPriMixer0_0), tiny);
  EXPECT_EQ(p.set_bits(Param::kRcArmChn, kIntCode, bits_of(-1), false), SetResult::kUnchanged);
}

TEST(Parameters, NegativeZeroPassesALimitOfZero) {
  Parameters p;
  EXPECT_EQ(p.set_float(Param::kNoLoadCurrent, -0.0f), SetResult::kChanged);
  EXPECT_EQ(p.get_float(Param::kNoLoadCurrent), 0.0f);
}

TEST(Parameters, AreFoundByTheirWholeName) {
  for (std::size_t k = 0; k < kParamCount; ++k) {
    EXPECT_EQ(Parameters::find(Parameters::row(static_cast<Param>(k)).name), k);
  }
  EXPECT_EQ(Parameters::find(padded_name("BAUD_RATE")), 0u);
  EXPECT_EQ(Parameters::find(padded_name("BATT_CURR_LPF")), 332u);
  EXPECT_EQ(Parameters::find(padded_name("BAUD_RAT")), kParamCount);
  EXPECT_EQ(Parameters::find(padded_name("BAUD_RATE_")), kParamCount);
  EXPECT_EQ(Parameters::find(padded_name("baud_rate")), kParamCount);
  EXPECT_EQ(Parameters::find(padded_name("")), kParamCount);
  // These have 16 characters and no NUL on the wire.
  for (const char* name : {"MOTOR_RESISTANCE", "PID_PITCH_RATE_P", "PID_PITCH_RATE_I",
                           "PID_PITCH_RATE_D", "RC_MAX_PITCHRATE", "OFFBOARD_TIMEOUT"}) {
    const std::size_t index = Parameters::find(padded_name(name));
    ASSERT_LT(index, kParamCount) << name;
    EXPECT_EQ(name_of(index), name);
  }
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const link::ParamName name = Parameters::row(static_cast<Param>(k)).name;
    EXPECT_EQ(Parameters::find(name), k);
    link::ParamName other = name;  // neighbours in the order are other names
    other[0] = static_cast<char>(other[0] + 1);
    EXPECT_NE(Parameters::find(other), k);
  }
  for (const char* name : {"A", "ZZZZZZZZZZZZZZZZ", "\x7F", "\xFF\xFF", "PID", "PRI_MIXER_"}) {
    EXPECT_EQ(Parameters::find(padded_name(name)), kParamCount);
  }
  link::ParamName dirty = padded_name("SYS_ID");
  dirty[10] = 'X';  // left over after the NUL
  EXPECT_EQ(Parameters::find(dirty), static_cast<std::size_t>(Param::kSysId));
}

TEST(Parameters, RememberWhatChanged) {
  Parameters p;
  static_cast<void>(p.take_changes());
  p.mark_all_reported();
  p.mark_saved(p.version());
  EXPECT_FALSE(p.has_changes());

  EXPECT_EQ(p.set_int(Param::kSysId, 1), SetResult::kUnchanged);
  EXPECT_EQ(p.set_int(Param::kSysId, 256), SetResult::kOutOfRange);
  EXPECT_FALSE(p.has_changes());
  EXPECT_FALSE(p.has_unreported());
  EXPECT_FALSE(p.unsaved());

  EXPECT_EQ(p.set_int(Param::kSysId, 7), SetResult::kChanged);
  EXPECT_EQ(p.set_float(Param::kMotorKv, 0.03f), SetResult::kChanged);
  EXPECT_TRUE(p.unsaved());
  const Parameters::ChangeSet changes = p.take_changes();
  EXPECT_EQ(changes.count(), 2u);
  EXPECT_TRUE(changes.test(static_cast<std::size_t>(Param::kSysId)));
  EXPECT_TRUE(changes.test(static_cast<std::size_t>(Param::kMotorKv)));
  EXPECT_FALSE(p.has_changes());
  EXPECT_TRUE(p.take_changes().none());

  Param id{};
  ASSERT_TRUE(p.take_unreported(id));
  EXPECT_EQ(id, Param::kMotorKv);  // lowest index first
  ASSERT_TRUE(p.take_unreported(id));
  EXPECT_EQ(id, Param::kSysId);
  EXPECT_FALSE(p.take_unreported(id));
  EXPECT_FALSE(p.has_unreported());
}

TEST(Parameters, AReportedChangeIsNotReportedAgain) {
  Parameters p;
  p.mark_all_reported();
  EXPECT_EQ(p.set_int(Param::kSysId, 7), SetResult::kChanged);
  EXPECT_EQ(p.set_int(Param::kNumMotors, 6), SetResult::kChanged);
  p.mark_reported(Param::kNumMotors);
  Param id{};
  ASSERT_TRUE(p.take_unreported(id));
  EXPECT_EQ(id, Param::kSysId);
  EXPECT_FALSE(p.take_unreported(id));
}

TEST(Parameters, DefaultsMarkOnlyWhatDiffered) {
  Parameters p;
  EXPECT_EQ(p.set_int(Param::kSysId, 7), SetResult::kChanged);
  static_cast<void>(p.take_changes());
  p.reset_to_defaults();
  const auto changes = p.take_changes();
  EXPECT_EQ(changes.count(), 1u);
  EXPECT_TRUE(changes.test(static_cast<std::size_t>(Param::kSysId)));
  EXPECT_EQ(p.get_int(Param::kSysId), 1);
}

}  // namespace
}  // namespace rosflight::core
