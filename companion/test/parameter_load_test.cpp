// SPDX-License-Identifier: BSD-3-Clause
// Many parameters at once: loads, and files.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "companion/parameter_client.hpp"
#include "companion/parameter_file.hpp"
#include "companion/test/rig.hpp"

namespace rosflight::companion::test {
namespace {

using Outcome = ParameterOutcome;

TEST(ParameterLoad, ReportsEachEntry) {
  auto table = numbered_table(12);
  table[4].max = 1.0;
  Rig rig(table);
  const auto job = rig.session.parameters().load({{"P001", ParameterValue::of(8.0f)},
                                                  {"P002", ParameterValue::of(0.2f)},
                                                  {"P003", ParameterValue::of(3.0f)},
                                                  {"P004", ParameterValue::of(2.0f)},
                                                  {"NOT_THERE", ParameterValue::of(1)}});
  ASSERT_TRUE(rig.run_job(job));
  EXPECT_TRUE(job.failed());
  const auto& entries = job.result().entries;
  ASSERT_EQ(entries.size(), 5U);
  EXPECT_EQ(entries[0].text, "P001: set to 8.0");
  EXPECT_EQ(entries[1].text, "P002: is already 0.2");
  EXPECT_EQ(entries[2].text, "P003: given as float, is int32");
  EXPECT_EQ(entries[3].text, "P004: 2 refused, stays at 0.4");
  EXPECT_EQ(entries[4].text, "NOT_THERE: no such parameter");
  EXPECT_EQ(
      job.text(),
      "5 parameters: 1 unchanged, 1 set, 1 refused, 1 unknown, 1 wrong type; first: P003: given as "
      "float, is int32");
}

class LossyLoad : public testing::TestWithParam<std::uint64_t> {};

// One byte in 300 lost: about every tenth frame; one in 100: every fourth; in both directions.
TEST_P(LossyLoad, AllArriveAndAreConfirmed) {
  Rig rig(numbered_table(333), {}, GetParam() % 4 < 2 ? 1.0 / 300.0 : 1.0 / 100.0, GetParam());
  rig.fcu.answers_equal_sets = GetParam() % 2 == 0;
  ParameterSet set;
  for (const auto& p : rig.fcu.parameters) {
    set.push_back({p.name, p.value.type == link::ParamType::kInt32 ? ParameterValue::of(1000)
                                                                   : ParameterValue::of(0.5f)});
  }
  const auto job = rig.session.parameters().load(set);
  ASSERT_TRUE(rig.run_job(job, 60s));
  EXPECT_TRUE(job.done()) << job.text();
  for (std::size_t i = 0; i < set.size(); ++i) {
    EXPECT_TRUE(same_value(rig.fcu.parameters[i].value, set[i].value)) << set[i].name;
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, LossyLoad, testing::Range<std::uint64_t>(1, 9));

// A mixer choice overwrites matrix entries that came earlier in the file; the second round puts
// them back.
TEST(ParameterLoad, LooksAgainAtWhatALaterEntryOverwrote) {
  Rig rig(numbered_table(12));
  bool overwritten = false;
  rig.fcu.intercept = [&](const link::Message& m) {
    const auto* set = std::get_if<link::ParamSet>(&m);
    if (set != nullptr && text_of(set->name) == "P009" && !overwritten) {
      overwritten = true;
      rig.fcu.set_from_inside("P001", ParameterValue::of(-1.0f));
    }
    return false;
  };
  const auto job = rig.session.parameters().load(
      {{"P001", ParameterValue::of(8.0f)}, {"P009", ParameterValue::of(11)}});
  ASSERT_TRUE(rig.run_job(job));
  EXPECT_TRUE(overwritten);
  EXPECT_TRUE(job.done()) << job.text();
  EXPECT_FLOAT_EQ(rig.fcu.find("P001")->value.as_float(), 8.0f);
}

TEST(ParameterLoad, GivesUpOnWhatTheFcuKeepsChangingBack) {
  Rig rig(numbered_table(12));
  rig.fcu.intercept = [&](const link::Message& m) {
    const auto* set = std::get_if<link::ParamSet>(&m);
    if (set != nullptr && text_of(set->name) == "P001") {
      rig.fcu.set_from_inside("P001", ParameterValue{link::ParamType::kFloat, set->value});
      rig.fcu.set_from_inside("P001", ParameterValue::of(-1.0f));
      return true;
    }
    return false;
  };
  const auto job = rig.session.parameters().load({{"P001", ParameterValue::of(8.0f)}});
  ASSERT_TRUE(rig.run_job(job));
  EXPECT_TRUE(job.failed());
  EXPECT_EQ(job.result().entries[0].text,
            "P001: set, but changed again by the flight control unit");
}

TEST(ParameterLoad, SurvivesARestartOfTheFcuOnTheWay) {
  Rig rig(numbered_table(200));
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  rig.run_for(1s);
  const auto original = rig.fcu.parameters;
  ParameterSet set;
  for (const auto& p : original) {
    set.push_back({p.name, p.value.type == link::ParamType::kInt32 ? ParameterValue::of(1000)
                                                                   : ParameterValue::of(0.5f)});
  }
  const auto job = rig.session.parameters().load(set);
  ASSERT_TRUE(rig.run_until([&] { return rig.fcu.count_received<link::ParamSet>() > 60; }));
  rig.fcu.restart();
  rig.fcu.parameters = original;  // nothing was stored
  ASSERT_TRUE(rig.run_job(job));
  EXPECT_TRUE(job.done()) << job.text();
  for (std::size_t i = 0; i < set.size(); ++i) {
    EXPECT_TRUE(same_value(rig.fcu.parameters[i].value, set[i].value)) << set[i].name;
  }
}

class ParameterFiles : public testing::Test {
 protected:
  ParameterFiles()
      : folder(std::filesystem::path(testing::TempDir()) / "companion_parameter_files") {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  ~ParameterFiles() override { std::filesystem::remove_all(folder); }
  std::filesystem::path folder;
};

TEST_F(ParameterFiles, WhatWasSavedLoadsUnchanged) {
  Rig rig(numbered_table(333));
  const auto saved = rig.session.parameters().save_file(folder / "all.yaml");
  EXPECT_TRUE(saved.pending());  // waits for the list
  ASSERT_TRUE(rig.run_job(saved));
  ASSERT_TRUE(saved.done()) << saved.text();
  EXPECT_EQ(saved.result().received, 333U);
  const auto loaded = rig.session.parameters().load_file(folder / "all.yaml");
  ASSERT_TRUE(rig.run_job(loaded));
  EXPECT_TRUE(loaded.done()) << loaded.text();
  EXPECT_EQ(loaded.text(), "333 parameters: 333 unchanged");
  EXPECT_EQ(rig.fcu.count_received<link::ParamSet>(), 0U);
}

TEST_F(ParameterFiles, AMixerIsChosenAfterWhatItIsCheckedAgainst) {
  auto table = numbered_table(2);
  table[0].name = "PRIMARY_MIXER";
  table[1].name = "RC_F_AXIS";
  Rig rig(std::move(table));
  write_parameter_file(folder / "fixedwing.yaml",
                       {{"PRIMARY_MIXER", ParameterValue::of(std::int32_t{10})},
                        {"RC_F_AXIS", ParameterValue::of(7.0f)}},
                       "");
  const auto loaded = rig.session.parameters().load_file(folder / "fixedwing.yaml");
  ASSERT_TRUE(rig.run_job(loaded));
  ASSERT_TRUE(loaded.done()) << loaded.text();
  std::vector<std::string> order;
  for (const link::Message& message : rig.fcu.received)
    if (const auto* set = std::get_if<link::ParamSet>(&message))
      order.emplace_back(text_of(set->name));
  order.erase(std::unique(order.begin(), order.end()), order.end());  // a value may be sent twice
  EXPECT_EQ(order, (std::vector<std::string>{"RC_F_AXIS", "PRIMARY_MIXER"}));
}

TEST_F(ParameterFiles, SavesOnlyWhatDiffersFromDefaults) {
  Rig rig(numbered_table(20));
  ParameterSet defaults;
  for (const auto& p : rig.fcu.parameters) {
    defaults.push_back({p.name, p.value});
  }
  rig.fcu.find("P004")->value = ParameterValue::of(4.5f);
  const auto saved = rig.session.parameters().save_file(folder / "mine.yaml", defaults);
  ASSERT_TRUE(rig.run_job(saved));
  const ParameterSet back = read_parameter_file(folder / "mine.yaml");
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back[0].name, "P004");
  EXPECT_FLOAT_EQ(back[0].value.as_float(), 4.5f);
}

TEST_F(ParameterFiles, SavingToABadPlaceFailsWithOneLine) {
  Rig rig;
  const auto saved = rig.session.parameters().save_file(folder / "none" / "a.yaml");
  ASSERT_TRUE(rig.run_job(saved));
  EXPECT_TRUE(saved.failed());
  EXPECT_EQ(saved.text(), (folder / "none" / "a.yaml.part").string() +
                              ": cannot create: No such file or directory");
}

TEST_F(ParameterFiles, AFileWithAnErrorSetsNothing) {
  Rig rig;
  std::ofstream(folder / "bad.yaml")
      << "- {name: P001, type: 9, value: 1.0}\n- {name: P002, type: 7, value: 1}\n";
  const auto loaded = rig.session.parameters().load_file(folder / "bad.yaml");
  EXPECT_TRUE(loaded.failed());
  EXPECT_NE(loaded.text().find("bad.yaml:2"), std::string::npos) << loaded.text();
  rig.run_for(1s);
  EXPECT_EQ(rig.fcu.count_received<link::ParamSet>(), 0U);
}

}  // namespace
}  // namespace rosflight::companion::test
