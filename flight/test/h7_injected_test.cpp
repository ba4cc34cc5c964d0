// SPDX-License-Identifier: BSD-3-Clause
// Errors injected into the buses, parts and flash of the emulated chip: what the firmware reports, and that the rest
// flies. The flights are short.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "flight/test/h7_rig.hpp"

namespace rosflight::flight::testing {
namespace {

using boards::stm32h7::FaultyPart;
using boards::stm32h7::HardwareFault;
using Breakdown = Autopilot::Breakdown;
using Texts = std::vector<std::string>;

/// A flight of 8 m, and what the firmware has reported in it.
struct Hop {
  /// @param state  what guidance flies on.
  explicit Hop(const std::string& board, const std::string& state = "estimate")
      : rig{choice(board, state)} {
    rig.flight->runner().set_notify([this](const FlightNote& note) {
      // What was lost in the other direction is of the start.
      if (note.source == "fcu") texts.push_back(note.text.substr(0, note.text.find(", out")));
    });
  }
  static FlightChoice choice(const std::string& board, const std::string& state) {
    FlightChoice choice = on_board({}, board);
    choice.mission = "hop";
    choice.state = state;
    return choice;
  }
  /// Gives the power back with a fault in the hardware.
  void power_on_with(HardwareFault fault, FaultyPart part) {
    chip_of(rig).inject(fault, part);
    rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kPowerLoss);
  }
  void fly_to_the_end() {
    rig.flight->run();
    EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
    EXPECT_EQ(chip_of(rig).figures()->resets, 0U);
    EXPECT_EQ(view_of(rig).errors, 0U);
  }
  /// Texts with one of these words in them.
  Texts with(const Texts& words) const {
    Texts found;
    for (const std::string& text : texts) {
      const auto in_text = [&text](const std::string& word) {
        return text.find(word) != std::string::npos;
      };
      if (std::any_of(words.begin(), words.end(), in_text)) found.push_back(text);
    }
    return found;
  }
  /// What was reported of sensors and of the link, but that they work.
  Texts bad_news() const {
    Texts found = with({"BMI088", "ADIS16500", "DPS310", "IST8308", "IIS2MDC", "MS4525DO", "DLHR",
                        "u-blox", "Sensor", "Link lost"});
    const auto is_good = [](const std::string& text) {
      return text.find(": started") != std::string::npos || text.find(": ok") != std::string::npos;
    };
    found.erase(std::remove_if(found.begin(), found.end(), is_good), found.end());
    return found;
  }

  Rig rig;
  Texts texts;
};

struct Error {
  HardwareFault fault;
  FaultyPart part;
};

struct Injected {
  const char* name;
  const char* board;
  std::vector<Error> errors;
  Texts bad_news;  ///< All that is reported of them.
  double lasts_s{0.0};
};
void PrintTo(const Injected& injected, std::ostream* out) {
  *out << injected.name << " of " << injected.board;
}

class InjectedInFlight : public ::testing::TestWithParam<Injected> {};

TEST_P(InjectedInFlight, IsReportedOnceAndTheRestFlies) {
  constexpr double kFault_s = 11.5, kBetween_s = 0.1, kReported_s = 2.5;
  const Injected& injected = GetParam();
  Hop hop{injected.board};
  hop.rig.run_until(kFault_s);
  ASSERT_TRUE(view_of(hop.rig).armed);
  ASSERT_GT(hop.rig.height_m(), 1.0);
  hop.texts.clear();
  for (const Error& each : injected.errors) {
    chip_of(hop.rig).inject(each.fault, each.part);
    hop.rig.run_for(kBetween_s);
  }
  hop.rig.run_for(injected.lasts_s);
  if (injected.lasts_s > 0.0) chip_of(hop.rig).inject(HardwareFault::kRepaired);
  hop.rig.run_for(kReported_s);
  EXPECT_EQ(hop.bad_news(), injected.bad_news);
  hop.fly_to_the_end();
  EXPECT_EQ(hop.bad_news(), injected.bad_news) << "nothing is repeated";
}

INSTANTIATE_TEST_SUITE_P(
    Errors, InjectedInFlight,
    ::testing::Values(Injected{"StuckBus",
                               "pixracer_pro",
                               {{HardwareFault::kStuckBus, FaultyPart::kMag}},
                               {"IST8308: bus stuck", "MS4525DO: bus stuck"},
                               1.0},
                      Injected{"NoAcknowledgement",
                               "varmint",
                               {{HardwareFault::kMute, FaultyPart::kPitot}},
                               {"DLHR: no answer"},
                               1.0},
                      Injected{"LostEdges",
                               "pixracer_pro",
                               {{HardwareFault::kLostEdges, FaultyPart::kImu}},
                               {"BMI088: no data ready"}},
                      Injected{"Overruns",
                               "pixracer_pro",
                               {{HardwareFault::kOverrun, FaultyPart::kImu},
                                {HardwareFault::kOverrun, FaultyPart::kLink}},
                               {"Link lost: in 1", "Sensor errors since start: 1"}},
                      Injected{"BrownOut",
                               "pixracer_pro",
                               {{HardwareFault::kBrownOut, FaultyPart::kImu}},
                               {"BMI088: no data ready"}},
                      // It is on three wires, and has lost that too: nothing drives the line.
                      Injected{"BrownOutOfTheBarometer",
                               "varmint",
                               {{HardwareFault::kBrownOut, FaultyPart::kBaro}},
                               {"DPS310: set-up lost, register 0x06 is 0xFF"}},
                      Injected{"FlippedBitOfABurst",
                               "varmint",
                               {{HardwareFault::kFlippedBit, FaultyPart::kImu}},
                               {"Sensor errors since start: 1"}},
                      // Nothing shows that the first is wrong; a lost solution is not worth a text.
                      Injected{"FlippedBitsAndALostByte",
                               "pixracer_pro",
                               {{HardwareFault::kFlippedBit, FaultyPart::kImu},
                                {HardwareFault::kFlippedBit, FaultyPart::kGnss},
                                {HardwareFault::kOverrun, FaultyPart::kGnss}},
                               {}}),
    [](const auto& injected) { return std::string(injected.param.name); });

// ---- from the power-on

struct WrongPart {
  const char* name;
  const char* board;
  Error error;
  const char* text;
};
void PrintTo(const WrongPart& wrong, std::ostream* out) {
  *out << wrong.name << " of " << wrong.board;
}

/// The companion's estimator does not become ready without these sensors, so that nobody would arm: guidance flies on the true
/// state, and what is tested is the firmware.
class WrongFromThePowerOn : public ::testing::TestWithParam<WrongPart> {};

TEST_P(WrongFromThePowerOn, IsOneTextAndTheRestFlies) {
  const WrongPart& wrong = GetParam();
  Hop hop{wrong.board, "truth"};
  hop.power_on_with(wrong.error.fault, wrong.error.part);
  hop.fly_to_the_end();
  const Texts bad_news = hop.bad_news();
  const auto of_start = [](const std::string& text) { return text.find("Link lost") == 0; };
  Texts of_parts;
  std::remove_copy_if(bad_news.begin(), bad_news.end(), std::back_inserter(of_parts), of_start);
  EXPECT_EQ(of_parts, (Texts{wrong.text}));
}

INSTANTIATE_TEST_SUITE_P(
    Parts, WrongFromThePowerOn,
    ::testing::Values(WrongPart{"MuteMagnetometer",
                                "pixracer_pro",
                                {HardwareFault::kMute, FaultyPart::kMag},
                                "IST8308: no answer"},
                      WrongPart{"AnotherBarometer",
                                "varmint",
                                {HardwareFault::kWrongIdentity, FaultyPart::kBaro},
                                "DPS310: identity 0x5A, expected 0x10"},
                      WrongPart{"ReceiverThatSpeaksNmea",
                                "varmint",
                                {HardwareFault::kSpeaksNmea, FaultyPart::kGnss},
                                "u-blox: sends NMEA at 38400 baud, ignores UBX"}),
    [](const auto& wrong) { return std::string(wrong.param.name); });

// ---- flash of the Varmint

/// A Varmint on the ground, and a parameter of it. The mission stores all parameters at 2.9 s.
struct Stored {
  Stored() : rig{on_board({}, "varmint")} {
    EXPECT_TRUE(rig.reach(Stage::kConfigure));
    rig.flight->runner().set_notify(nullptr);
    rig.run_for(0.2);
  }
  void set(double value) {
    auto set = rig.flight->session().parameters().set("FILT_ACC_KP", value);
    rig.run_for(0.1);
    EXPECT_FALSE(set.pending());
  }
  void save() {
    auto stored = rig.flight->session().commands().start(link::Command::kWriteParams);
    rig.run_for(0.3);
    EXPECT_FALSE(stored.pending() || stored.failed()) << stored.text();
  }
  double value_after_power_loss() {
    rig.flight->autopilot().break_down(rig.flight->now(), Breakdown::kPowerLoss);
    rig.run_for(1.0);
    auto read = rig.flight->session().parameters().read("FILT_ACC_KP");
    rig.run_for(0.3);
    EXPECT_FALSE(read.pending());
    return rig.flight->session().parameters().get("FILT_ACC_KP")->number();
  }
  Rig rig;
};

constexpr double kOld = 0.875, kNew = 0.625;

TEST(FlashOfTheVarmint, WithAnyOneWordTornLeavesASetThatWasSaved) {
  Stored stored;
  for (const double value : {kOld, kNew}) {
    stored.set(value);
    stored.save();
  }
  unsigned newest = 0;
  // Both marks of the sector, and words of the first and of the second slot.
  const std::vector<std::uint16_t> words{0, 1, 2, 150, 320, 420};
  for (const std::uint16_t word : words) {
    chip_of(stored.rig).tear_flash(word);
    const double value = stored.value_after_power_loss();
    EXPECT_TRUE(value == kOld || value == kNew) << value << " with word " << word;
    newest += value == kNew ? 1 : 0;
  }
  EXPECT_GE(newest, 4U) << "one word of the newest set at most costs it";
  EXPECT_EQ(chip_of(stored.rig).figures()->resets, 0U);
}

TEST(FlashOfTheVarmint, PowerLostDuringASaveLeavesTheOldOrTheNewSet) {
  unsigned torn = 0;
  for (const int steps : {0, 1, 2}) {
    Stored stored;
    const auto& chip = chip_of(stored.rig).process().from_chip();
    stored.set(kOld);
    stored.save();
    stored.set(kNew);
    auto saved = stored.rig.flight->session().commands().start(link::Command::kWriteParams);
    for (int k = 0; k < 50 && chip.flash_is_busy == 0; ++k) stored.rig.flight->step();
    ASSERT_NE(chip.flash_is_busy, 0);
    for (int k = 0; k < steps; ++k) stored.rig.flight->step();
    const double value = stored.value_after_power_loss();
    EXPECT_TRUE(value == kOld || value == kNew) << value << " after " << steps << " steps";
    torn += chip.torn_words;
    EXPECT_EQ(chip_of(stored.rig).figures()->resets, 0U);
  }
  EXPECT_GE(torn, 1U) << "a word was being written";
}

/// A sector that cannot be read is erased at the start, which takes 1.5 s.
TEST(FlashOfTheVarmint, PowerLostDuringAnEraseLeavesTheSet) {
  Stored stored;
  stored.set(kOld);
  stored.save();
  chip_of(stored.rig).inject(HardwareFault::kDamagedFlash);
  EXPECT_EQ(stored.value_after_power_loss(), kOld);
  EXPECT_EQ(stored.value_after_power_loss(), kOld);
  EXPECT_GT(chip_of(stored.rig).process().from_chip().torn_words, 100U) << "it was being erased";
}

class TornInFlight : public ::testing::TestWithParam<std::uint16_t> {};

/// The parameters are read by the start that follows a crash.
TEST_P(TornInFlight, CostsOneResetAndTheFlightGoesOn) {
  Hop hop{"varmint"};
  hop.rig.run_until(9.0);
  ASSERT_TRUE(view_of(hop.rig).armed);
  chip_of(hop.rig).tear_flash(GetParam());
  hop.rig.run_for(0.1);
  hop.rig.flight->autopilot().break_down(hop.rig.flight->now(), Breakdown::kCrash);
  hop.rig.run_for(3.0);
  EXPECT_EQ(chip_of(hop.rig).figures()->resets, 1U);
  EXPECT_TRUE(view_of(hop.rig).armed);
  EXPECT_GT(hop.rig.height_m(), 1.0);
  EXPECT_LT(hop.rig.tilt_deg(), 30.0);
}
/// A mark of the sector, and a word in the middle of the parameters.
INSTANTIATE_TEST_SUITE_P(Words, TornInFlight, ::testing::Values(0, 150));

}  // namespace
}  // namespace rosflight::flight::testing
