// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/mixer_setup.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/core/mixer_frames.hpp"

namespace rosflight::core {
namespace {

std::size_t index_of(const std::string& name) {
  const std::size_t index = Parameters::find(padded_name(name.c_str()));
  EXPECT_LT(index, kParamCount) << name;
  return index;
}
std::string pair(int input, int channel) {
  return std::to_string(input) + "_" + std::to_string(channel);
}
float gain(const Parameters& p, const char* prefix, int input, int channel) {
  return p.get_float(static_cast<Param>(index_of(prefix + pair(input, channel))));
}

struct Bench {
  Parameters parameters;
  Mixer mixer;
  Log log;

  void set(const std::string& name, std::int32_t value) {
    EXPECT_NE(parameters.set_int(static_cast<Param>(index_of(name)), value),
              SetResult::kOutOfRange);
  }
  void set_float(const std::string& name, float value) {
    EXPECT_NE(parameters.set_float(static_cast<Param>(index_of(name)), value),
              SetResult::kOutOfRange);
  }
  bool choose() { return choose_mixers(parameters, mixer, log); }
  /// What the main loop does with changed parameters.
  bool carry_changes() { return take_mixer_changes(parameters.take_changes(), parameters, mixer); }
  std::vector<std::pair<Severity, std::string>> texts() {
    std::vector<std::pair<Severity, std::string>> out;
    while (!log.empty()) {
      const link::StatusText text = log.pop();
      out.emplace_back(text.severity, text.text.data());
    }
    return out;
  }
};

TEST(MixerSetup, DefaultsHaveNoMixer) {
  Bench s;
  EXPECT_FALSE(s.choose());
  EXPECT_FALSE(s.mixer.valid());
  EXPECT_EQ(s.texts().front().first, Severity::kError);
  for (const float rate : output_rates(s.mixer.header())) EXPECT_EQ(rate, 50.0f);
}

TEST(MixerSetup, RatesWithoutMixerAre50HzWhateverWasChosenBefore) {
  Bench s;
  s.set("PRIMARY_MIXER", 2);
  ASSERT_TRUE(s.choose());
  s.set("PRIMARY_MIXER", 255);
  EXPECT_FALSE(s.choose());
  for (const float rate : output_rates(s.mixer.header())) EXPECT_EQ(rate, 50.0f);
  for (const float value : s.mixer.step({0, 0, -1.0f}, {1.225f, 24.0f, true, 0x3FF})) {
    EXPECT_EQ(value, 0.0f);
  }
}

TEST(MixerSetup, APredefinedPrimaryIsSavedToItsParameters) {
  for (std::int32_t id = 0; id <= 10; ++id) {
    SCOPED_TRACE(id);
    Bench s;
    s.set("PRIMARY_MIXER", id);
    if (id >= 9) s.set("RC_F_AXIS", 0);
    ASSERT_TRUE(s.choose());
    const MixerHeader header = frame_header(static_cast<MixerId>(id));
    const MixerGains gains = frame_gains(static_cast<MixerId>(id));
    EXPECT_EQ(s.mixer.primary(), gains);
    EXPECT_EQ(s.mixer.secondary(), gains);  // none of its own: a copy
    for (int channel = 0; channel < 10; ++channel) {
      const auto k = static_cast<std::size_t>(channel);
      EXPECT_EQ(s.mixer.header().type[k], header.type[k]);
      const auto type = static_cast<Param>(index_of("PRI_MIXER_OUT_" + std::to_string(channel)));
      EXPECT_EQ(s.parameters.get_int(type), static_cast<std::int32_t>(header.type[k]));
      const auto rate = static_cast<Param>(index_of("PRI_MIXER_PWM_" + std::to_string(channel)));
      EXPECT_EQ(s.parameters.get_float(rate), header.rate_hz[k]);
      for (int input = 0; input < 10; ++input) {
        EXPECT_EQ(gain(s.parameters, "PRI_MIXER_", input, channel), gains(channel, input));
        EXPECT_EQ(gain(s.parameters, "SEC_MIXER_", input, channel), gains(channel, input));
      }
    }
    for (const auto& [severity, text] : s.texts()) {
      if (id == 0 && severity == Severity::kCritical) continue;  // see below
      EXPECT_EQ(severity, Severity::kInfo) << text;
    }
  }
}

TEST(MixerSetup, SavedGainsAreNewsForTheCompanion) {
  Bench s;
  s.parameters.mark_all_reported();
  s.set("PRIMARY_MIXER", 2);
  ASSERT_TRUE(s.choose());
  int count = 0;
  Param id{};
  while (s.parameters.take_unreported(id)) ++count;
  // The choice, 4 types, 10 rates and 16 gains, the gains once more as the secondary.
  EXPECT_EQ(count, 1 + 4 + 10 + 2 * 16);
}

TEST(MixerSetup, CarryingItsOwnChangesMakesNoMore) {
  Bench s;
  s.set("PRIMARY_MIXER", 6);
  ASSERT_TRUE(s.choose());
  const MixerGains gains = s.mixer.primary();
  static_cast<void>(s.carry_changes());
  static_cast<void>(s.carry_changes());
  EXPECT_FALSE(s.parameters.has_changes());
  EXPECT_EQ(s.mixer.primary(), gains);
  EXPECT_EQ(s.mixer.secondary(), gains);
}

TEST(MixerSetup, ThePredefinedSecondaryIsNotInvertedTwice) {
  // Weak point 44: ROSflight 2.x turns the V-tail's 0.5 into 1.
  Bench s;
  s.set("PRIMARY_MIXER", 9);
  s.set("SECONDARY_MIXER", 10);
  s.set("RC_F_AXIS", 0);
  ASSERT_TRUE(s.choose());
  EXPECT_EQ(s.mixer.primary(), frame_gains(MixerId::kFixedWing));
  EXPECT_EQ(s.mixer.secondary()(1, 4), -0.5f);
  EXPECT_EQ(s.mixer.secondary()(2, 4), 0.5f);
  EXPECT_EQ(s.mixer.secondary()(1, 5), 0.5f);
  EXPECT_EQ(s.mixer.secondary()(2, 5), 0.5f);
  EXPECT_EQ(gain(s.parameters, "SEC_MIXER_", 4, 1), -0.5f);
  // The header is the primary's.
  EXPECT_EQ(s.mixer.header().type, frame_header(MixerId::kFixedWing).type);
}

TEST(MixerSetup, TakesACustomMixerFromItsParameters) {
  Bench s;
  s.set("PRIMARY_MIXER", 11);
  s.set("SECONDARY_MIXER", 11);
  s.set("PRI_MIXER_OUT_3", 2);
  s.set("PRI_MIXER_OUT_7", 1);
  s.set_float("PRI_MIXER_PWM_3", 400.0f);
  s.set_float("PRI_MIXER_2_3", -0.8f);  // input 2 (F_z) to channel 3
  s.set_float("PRI_MIXER_6_7", 0.3f);
  s.set_float("SEC_MIXER_0_3", 0.9f);
  ASSERT_TRUE(s.choose());
  EXPECT_EQ(s.mixer.header().type[3], OutputType::kMotor);
  EXPECT_EQ(s.mixer.header().type[7], OutputType::kServo);
  EXPECT_EQ(s.mixer.header().type[0], OutputType::kAux);
  EXPECT_EQ(s.mixer.primary()(3, 2), -0.8f);
  EXPECT_EQ(s.mixer.primary()(7, 6), 0.3f);
  EXPECT_EQ(s.mixer.secondary()(3, 0), 0.9f);
  EXPECT_EQ(s.mixer.primary().cwiseAbs().sum(), 0.8f + 0.3f);
  EXPECT_EQ(s.mixer.secondary().cwiseAbs().sum(), 0.9f);
}

TEST(MixerSetup, TreatsARateOfZeroAs50Hz) {
  // Weak point 46: ROSflight 2.x divides by it.
  MixerHeader header;
  header.rate_hz = {0.0f, 490.0f, 0.0f, -0.0f, 50.0f, 300000.0f, 0.0f, 0.0f, 0.0f, 1.0f};
  const hal::OutputRates rates = output_rates(header);
  EXPECT_EQ(rates, (hal::OutputRates{50, 490, 50, 50, 50, 300000, 50, 50, 50, 1}));
}

TEST(MixerSetup, AChannelOfTypeGpioIsALevelWhateverItsRate) {
  MixerHeader header;
  header.rate_hz = {0.0f, 490.0f, 0.0f, 300000.0f, 50.0f};
  header.type = {OutputType::kGpio, OutputType::kGpio, OutputType::kMotor, OutputType::kGpio,
                 OutputType::kServo};
  const hal::OutputRates rates = output_rates(header);
  EXPECT_EQ(rates, (hal::OutputRates{0, 0, 50, 0, 50, 50, 50, 50, 50, 50}))
      << "and no other is, so that no motor is driven by a level";
}

TEST(MixerSetup, ClearsOutputs) {
  Bench s;
  s.set("PRIMARY_MIXER", 2);
  ASSERT_TRUE(s.choose());
  static_cast<void>(s.mixer.step({0, 0, -0.5f}, {1.225f, 24.0f, true, 0x3FF}));
  ASSERT_GT(s.mixer.outputs()[0], 0.0f);
  ASSERT_TRUE(s.choose());
  for (const float value : s.mixer.outputs()) EXPECT_EQ(value, 0.0f);
}

TEST(MixerSetup, TheMixerThatCalibratesSpeedControllersIsACriticalText) {
  for (std::int32_t id = 0; id <= 11; ++id) {
    Bench s;
    s.set("PRIMARY_MIXER", id);
    s.set("USE_MOTOR_PARAM", 1);
    static_cast<void>(s.choose());
    int critical = 0;
    for (const auto& [severity, text] : s.texts()) {
      if (severity != Severity::kCritical) continue;
      ++critical;
      EXPECT_EQ(text, "ESC calibration mixer: stick drives all motors");
    }
    EXPECT_EQ(critical, id == 0 ? 1 : 0) << id;
  }
}

TEST(MixerSetup, WarnsOfAMultirotorWhoseThrottleIsOnAnotherAxis) {
  for (const std::int32_t id : {0, 2, 8}) {
    Bench s;
    s.set("PRIMARY_MIXER", id);
    s.set("RC_F_AXIS", 0);
    ASSERT_TRUE(s.choose());
    int warnings = 0;
    for (const auto& [severity, text] : s.texts()) {
      warnings += severity == Severity::kWarning ? 1 : 0;
    }
    EXPECT_EQ(warnings, 2) << id;
  }
}

TEST(MixerSetup, WarnsOfChoicesThatCannotWork) {
  Bench multirotor;
  multirotor.set("PRIMARY_MIXER", 2);
  multirotor.set("USE_MOTOR_PARAM", 1);
  ASSERT_TRUE(multirotor.choose());
  Bench fixed_wing;
  fixed_wing.set("PRIMARY_MIXER", 9);  // RC_F_AXIS is 2: throttle would be lost
  ASSERT_TRUE(fixed_wing.choose());
  for (Bench* s : {&multirotor, &fixed_wing}) {
    int warnings = 0;
    for (const auto& [severity, text] : s->texts())
      warnings += severity == Severity::kWarning ? 1 : 0;
    EXPECT_EQ(warnings, 2);
  }
}

// ---- live changes

TEST(MixerChanges, AnElementTakesEffectAtOnceAndTheSecondaryFollows) {
  Bench s;
  s.set("PRIMARY_MIXER", 2);
  ASSERT_TRUE(s.choose());
  static_cast<void>(s.carry_changes());
  s.set_float("PRI_MIXER_3_1", 0.125f);
  EXPECT_FALSE(s.carry_changes());  // no rate changed
  EXPECT_EQ(s.mixer.primary()(1, 3), 0.125f);
  EXPECT_EQ(s.mixer.secondary()(1, 3), 0.125f);
  EXPECT_EQ(gain(s.parameters, "SEC_MIXER_", 3, 1), 0.125f);
  EXPECT_TRUE(s.mixer.mixers_agree());
}

TEST(MixerChanges, ASecondaryOfItsOwnDoesNotFollow) {
  for (const std::int32_t secondary : {2, 11}) {
    Bench s;
    s.set("PRIMARY_MIXER", 2);
    s.set("SECONDARY_MIXER", secondary);
    ASSERT_TRUE(s.choose());
    static_cast<void>(s.carry_changes());
    const MixerGains before = s.mixer.secondary();
    s.set_float("PRI_MIXER_3_1", 0.125f);
    static_cast<void>(s.carry_changes());
    EXPECT_EQ(s.mixer.primary()(1, 3), 0.125f);
    EXPECT_EQ(s.mixer.secondary(), before);
    s.set_float("SEC_MIXER_3_1", 0.25f);
    static_cast<void>(s.carry_changes());
    EXPECT_EQ(s.mixer.primary()(1, 3), 0.125f);
    EXPECT_EQ(s.mixer.secondary()(1, 3), 0.25f);
  }
}

TEST(MixerChanges, OfKindsAndRatesConcernTheBoard) {
  // Weak point 45: a changed rate reaches the hardware; both are locked while armed.
  Bench s;
  s.set("PRIMARY_MIXER", 11);
  ASSERT_TRUE(s.choose());
  static_cast<void>(s.carry_changes());
  s.set_float("PRI_MIXER_PWM_4", 333.0f);
  EXPECT_TRUE(s.carry_changes());
  EXPECT_EQ(output_rates(s.mixer.header())[4], 333.0f);
  s.set("PRI_MIXER_OUT_4", 2);
  EXPECT_TRUE(s.carry_changes());
  EXPECT_EQ(s.mixer.header().type[4], OutputType::kMotor);
  EXPECT_EQ(output_rates(s.mixer.header())[4], 333.0f);
  EXPECT_FALSE(s.carry_changes());
}

}  // namespace
}  // namespace rosflight::core
