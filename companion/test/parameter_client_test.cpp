// SPDX-License-Identifier: BSD-3-Clause
#include "companion/parameter_client.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "companion/test/rig.hpp"

namespace rosflight::companion::test {
namespace {

using Outcome = ParameterOutcome;

// The FCU sends one value a pass: 333 passes, and no request beyond the one for the list.
TEST(ParameterList, ArrivesCompleteInOneTransferOnACleanLink) {
  Rig rig(numbered_table(333));
  ASSERT_TRUE(
      rig.run_until([&] { return rig.session.parameters().complete(); }, 333 * Rig::kStep + 20ms));
  EXPECT_EQ(rig.fcu.count_received<link::ParamRequestRead>(), 0U);
  const auto events = rig.log.of<ParameterListEvent>();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_FALSE(events[0].complete);
  EXPECT_TRUE(events[1].complete);
  EXPECT_EQ(events[1].count, 333U);
  for (std::size_t i = 0; i < 333; ++i) {
    const auto& p = rig.fcu.parameters[i];
    EXPECT_TRUE(same_value(rig.mirror(p.name), p.value)) << p.name;
  }
}

class LossyList : public testing::TestWithParam<std::uint64_t> {};

// 1 % of the bytes lost breaks 28 % of the 33-byte value frames.
TEST_P(LossyList, GapsAreFilledByIndex) {
  Rig rig(numbered_table(333), {}, 0.01, GetParam());
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }, 20s));
  EXPECT_GT(rig.fcu.count_received<link::ParamRequestRead>(), 40U);
  EXPECT_LT(rig.fcu.count_received<link::ParamRequestRead>(), 500U);
  for (const auto& p : rig.fcu.parameters) {
    ASSERT_TRUE(same_value(rig.mirror(p.name), p.value)) << p.name;
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, LossyList, testing::Range<std::uint64_t>(1, 9));

TEST(ParameterList, IsAskedForOnceASecondUntilTheFcuIsThere) {
  Rig rig;
  rig.fcu.silent = true;
  rig.run_for(5s);
  EXPECT_FALSE(rig.session.parameters().complete());
  EXPECT_NEAR(static_cast<double>(rig.session.parameters().list_counters().list_requests), 5.0,
              1.0);
  rig.fcu.silent = false;
  EXPECT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }, 1100ms));
}

TEST(ParameterList, StartsAgainWhenTheFcuRestartsInTheMiddle) {
  Rig rig(numbered_table(333));
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().table().known() == 150; }));
  rig.fcu.restart();
  for (auto& p : rig.fcu.parameters) {
    p.value =
        p.value.type == link::ParamType::kInt32 ? ParameterValue::of(7) : ParameterValue::of(7.5f);
  }
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }, 5s));
  for (const auto& p : rig.fcu.parameters) {
    EXPECT_TRUE(same_value(rig.mirror(p.name), p.value)) << p.name;
  }
  EXPECT_EQ(rig.log.count(ConnectionChange::kRestarted), 1U);
  EXPECT_FALSE(rig.session.parameters().unsaved());
}

TEST(ParameterList, MalformedAndForeignValuesChangeNothing) {
  Rig rig(numbered_table(10));
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  const auto send = [&](const char* name, std::uint16_t count, std::uint16_t index,
                        link::ParamType type) {
    link::ParamValue m;
    copy_text(name, m.name);
    m.count = count;
    m.index = index;
    m.type = type;
    m.value.bits = 0x12345678;
    rig.fcu.send(m);
    rig.step();
  };
  const auto before = rig.session.parameters().counters();
  send("P001", 0, 0, link::ParamType::kFloat);                           // 0 of 0
  send("P001", 10, 10, link::ParamType::kFloat);                         // index past the end
  send("", 10, 1, link::ParamType::kFloat);                              // no name
  send("P\001", 10, 1, link::ParamType::kFloat);                         // control character
  send("P001", 10, 1, std::bit_cast<link::ParamType>(std::uint8_t{3}));  // no such type
  send("P001", 65535, 65534, link::ParamType::kFloat);                   // beyond any FCU
  EXPECT_EQ(rig.session.parameters().counters().malformed - before.malformed, 6U);
  send("P001", 10, 2, link::ParamType::kFloat);  // stands elsewhere
  send("P001", 10, 1, link::ParamType::kInt32);  // has another type
  EXPECT_EQ(rig.session.parameters().counters().foreign - before.foreign, 2U);
  EXPECT_FLOAT_EQ(rig.mirror("P001").as_float(), 0.1f);
  EXPECT_FLOAT_EQ(rig.mirror("P002").as_float(), 0.2f);
  EXPECT_TRUE(rig.session.parameters().complete());
}

// Another firmware flashed while the cable was off: its values do not fit and the table is read
// again.
TEST(ParameterList, AnotherTableReplacesTheOldOne) {
  Rig rig(numbered_table(10));
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  rig.fcu.parameters = numbered_table(12);
  rig.fcu.parameters[3].name = "NEW_ONE";
  rig.session.parameters().refresh();
  ASSERT_TRUE(rig.run_until([&] {
    return rig.session.parameters().table().all_fresh() &&
           rig.session.parameters().table().count() == 12;
  }));
  EXPECT_TRUE(rig.session.parameters().get("NEW_ONE"));
  EXPECT_FALSE(rig.session.parameters().get("P003"));
}

TEST(ParameterList, RefreshFailsWithNumbersWhenTheFcuIsGone) {
  Rig rig(numbered_table(10));
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  rig.fcu.silent = true;
  const auto job = rig.session.parameters().refresh();
  ASSERT_TRUE(rig.run_job(job));
  EXPECT_TRUE(job.failed());
  EXPECT_EQ(job.text(), "parameter list incomplete: 0 of 10 received");
  EXPECT_NEAR(to_seconds(job.duration()), 30.0, 0.1);
}

TEST(ParameterSet, IsConfirmedByTheFcu) {
  Rig rig;
  const auto as_float = rig.session.parameters().set("P001", 2.25);
  const auto as_int = rig.session.parameters().set("P003", -7);
  ASSERT_TRUE(rig.run_job(as_float));
  ASSERT_TRUE(rig.run_job(as_int));
  EXPECT_EQ(as_float.result().outcome, Outcome::kSet);
  EXPECT_EQ(as_float.text(), "P001: set to 2.25");
  EXPECT_EQ(as_int.result().value.value_or(ParameterValue{}).as_int32(), -7);
  EXPECT_FLOAT_EQ(rig.fcu.find("P001")->value.as_float(), 2.25f);
  EXPECT_EQ(rig.fcu.find("P003")->value.as_int32(), -7);
  EXPECT_TRUE(rig.session.parameters().unsaved());
}

// ROSflight 2.x does not answer a set of the value it has.
TEST(ParameterSet, OfTheSameValueIsConfirmedByReading) {
  for (const bool answers : {true, false}) {
    Rig rig;
    rig.fcu.answers_equal_sets = answers;
    ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
    const auto job = rig.session.parameters().set("P001", static_cast<double>(0.1f));
    ASSERT_TRUE(rig.run_job(job, 1s));
    EXPECT_EQ(job.result().outcome, Outcome::kUnchanged);
    EXPECT_EQ(rig.fcu.count_received<link::ParamSet>(), 0U);
    EXPECT_FALSE(rig.session.parameters().unsaved());
  }
}

// The mirror is old: what looks equal is not, and the set must still happen.
TEST(ParameterSet, DoesNotTrustAStaleMirror) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  rig.fcu.find("P001")->value = ParameterValue::of(9.0f);
  const auto job = rig.session.parameters().set("P001", static_cast<double>(0.1f));
  ASSERT_TRUE(rig.run_job(job, 1s));
  EXPECT_EQ(job.result().outcome, Outcome::kSet);
  EXPECT_FLOAT_EQ(rig.fcu.find("P001")->value.as_float(), 0.1f);
}

// The set took effect, its echo was lost; an FCU of ROSflight 2.x stays silent at the repetition.
TEST(ParameterSet, SurvivesALostEchoOfAnFcuThatIsSilentOnEqualSets) {
  Rig rig;
  rig.fcu.answers_equal_sets = false;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  bool lost = false;
  rig.fcu.intercept = [&](const link::Message& m) {
    if (!lost && std::holds_alternative<link::ParamSet>(m)) {
      lost = true;
      rig.fcu.find("P001")->value = ParameterValue::of(3.0f);
      return true;
    }
    return false;
  };
  const auto job = rig.session.parameters().set("P001", 3.0);
  ASSERT_TRUE(rig.run_job(job, 1s));
  EXPECT_TRUE(lost);
  EXPECT_EQ(job.result().outcome, Outcome::kSet);
}

TEST(ParameterSet, ReportsRefusedAndClampedValues) {
  auto table = numbered_table(6);
  table[1].min = 0.0;
  table[1].max = 1.0;
  table[2] = table[1];
  table[2].name = "P002";
  table[2].refuse_out_of_range = false;
  Rig rig(table);
  const auto refused = rig.session.parameters().set("P001", 5.0);
  const auto clamped = rig.session.parameters().set("P002", 5.0);
  ASSERT_TRUE(rig.run_job(refused));
  ASSERT_TRUE(rig.run_job(clamped));
  EXPECT_TRUE(refused.failed());
  EXPECT_EQ(refused.result().outcome, Outcome::kRefused);
  EXPECT_EQ(refused.text(), "P001: 5 refused, stays at 0.1");
  EXPECT_TRUE(clamped.failed());
  EXPECT_EQ(clamped.result().outcome, Outcome::kClamped);
  EXPECT_EQ(clamped.text(), "P002: 5 not taken, is now 1.0");
  EXPECT_FLOAT_EQ(clamped.result().value.value_or(ParameterValue{}).as_float(), 1.0f);
}

// The firmware may tell each refusal in its log: two are enough to be sure.
TEST(ParameterSet, IsRefusedAfterTwoTries) {
  auto table = numbered_table(6);
  table[1].max = 1.0;
  Rig rig(table);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  const auto job = rig.session.parameters().set("P001", 5.0);
  ASSERT_TRUE(rig.run_job(job, 100ms));
  EXPECT_EQ(rig.fcu.count_received<link::ParamSet>(), 2U);
}

TEST(ParameterSet, IsRefusedByAnFcuThatSaysNothingToIt) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  rig.fcu.intercept = [](const link::Message& m) {
    return std::holds_alternative<link::ParamSet>(m);
  };
  const auto job = rig.session.parameters().set("P001", 5.0);
  ASSERT_TRUE(rig.run_job(job, 10s));
  EXPECT_EQ(job.text(), "P001: 5 refused, stays at 0.1");
}

// A list transfer brings the old value after the set has left: that is no refusal.
TEST(ParameterSet, IsNotFooledByAnOldValueOnItsWay) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  rig.fcu.intercept = [&](const link::Message& m) {
    if (std::holds_alternative<link::ParamSet>(m)) {
      rig.fcu.send_value(1);
    }
    return false;
  };
  const auto job = rig.session.parameters().set("P001", 4.0);
  ASSERT_TRUE(rig.run_job(job, 1s));
  EXPECT_EQ(job.result().outcome, Outcome::kSet);
}

// The FCU is busy before the last row of its table; the companion asks for that row again and again. The list
// then ends with the row, and the answers arrive after the set has left.
TEST(ParameterSet, IsNotFooledByLateAnswersToRequestsOfTheList) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().table().known() == 19; }));
  std::size_t late = 0;
  rig.fcu.intercept = [&](const link::Message& m) {
    const auto* const read = std::get_if<link::ParamRequestRead>(&m);
    if (read != nullptr && read->index == 19 && rig.fcu.count_received<link::ParamSet>() == 0) {
      ++late;
      return true;
    }
    if (std::holds_alternative<link::ParamSet>(m)) {
      for (; late > 0; --late) rig.fcu.send_value(19);
    }
    return false;
  };
  for (const Time end = rig.now + 900ms; rig.now < end;) {
    rig.now += Rig::kStep;
    rig.session.step(rig.now);
  }
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  ASSERT_GE(late, 3U);
  const auto job = rig.session.parameters().set("P019", 4.0);
  ASSERT_TRUE(rig.run_job(job, 1s));
  EXPECT_EQ(job.text(), "P019: set to 4.0");
}

TEST(ParameterSet, RefusesWhatNoParameterCanHoldWithoutAskingTheFcu) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  struct Case {
    const char* name;
    double value;
    Outcome outcome;
    const char* text;
  };
  const Case cases[] = {
      {"P000", 0.5, Outcome::kRefused, "P000: must be a whole number"},
      {"P000", 2147483648.0, Outcome::kRefused, "P000: too large for an int32"},
      {"P000", std::numeric_limits<double>::quiet_NaN(), Outcome::kRefused,
       "P000: not a finite number"},
      {"P001", 1e39, Outcome::kRefused, "P001: too large for a float"},
      {"P001", std::numeric_limits<double>::infinity(), Outcome::kRefused,
       "P001: not a finite number"},
      {"NO_SUCH", 1.0, Outcome::kUnknown, "NO_SUCH: no such parameter"},
      {"MUCH_TOO_LONG_FOR_IT", 1.0, Outcome::kUnknown, "MUCH_TOO_LONG_FOR_IT: no such parameter"},
      {"", 1.0, Outcome::kUnknown, ": no such parameter"},
  };
  for (const Case& c : cases) {
    const auto job = rig.session.parameters().set(c.name, c.value);
    ASSERT_TRUE(rig.run_job(job, 100ms)) << c.text;
    EXPECT_EQ(job.result().outcome, c.outcome) << c.text;
    EXPECT_EQ(job.text(), c.text);
  }
  EXPECT_EQ(rig.fcu.count_received<link::ParamSet>(), 0U);
}

TEST(ParameterSet, EndsWithoutAnswerWhenTheFcuIsSilent) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  rig.fcu.silent = true;
  std::vector<Job<ParameterResult>> jobs;
  jobs.reserve(20);
  for (int i = 0; i < 20; ++i) {
    jobs.push_back(
        rig.session.parameters().set(rig.fcu.parameters[static_cast<std::size_t>(i)].name, 50.0));
  }
  ASSERT_TRUE(rig.run_job(jobs.back(), 10s));
  for (const auto& job : jobs) {
    EXPECT_TRUE(job.failed());
    EXPECT_EQ(job.result().outcome, Outcome::kNoAnswer);
  }
  EXPECT_LT(to_seconds(jobs.back().duration()),
            6.0);  // those that waited their turn end with the first
}

TEST(ParameterSet, EndsWithAReasonWhenTheLinkStaysClosed) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  rig.link.plug(false);
  const auto job = rig.session.parameters().set("P001", 4.0);
  ASSERT_TRUE(rig.run_job(job, 11s));
  EXPECT_TRUE(job.failed());
  EXPECT_EQ(job.text(), "P001: the link is closed");
}

TEST(ParameterSet, BeforeTheListIsInAsksByName) {
  auto table = numbered_table(300);
  Rig rig(table);
  rig.run_for(3 * Rig::kStep);
  const auto job = rig.session.parameters().set("P290", 4.0);
  ASSERT_TRUE(rig.run_job(job, 200ms));  // the list takes 750 ms to come there
  EXPECT_EQ(job.result().outcome, Outcome::kSet);
}

TEST(ParameterSet, TwoOfTheSameNameAreDoneInOrder) {
  Rig rig;
  const auto first = rig.session.parameters().set("P001", 4.0);
  const auto second = rig.session.parameters().set("P001", 5.0);
  ASSERT_TRUE(rig.run_job(second));
  EXPECT_EQ(first.result().outcome, Outcome::kSet);
  EXPECT_EQ(second.result().outcome, Outcome::kSet);
  EXPECT_FLOAT_EQ(rig.fcu.find("P001")->value.as_float(), 5.0f);
}

TEST(ParameterJob, CallsBackOnceAndMayStartAnother) {
  Rig rig;
  int calls = 0;
  Job<ParameterResult> second;
  auto first = rig.session.parameters().set("P001", 4.0);
  first.when_finished([&] {
    ++calls;
    second = rig.session.parameters().set("P002", 4.0);
  });
  ASSERT_TRUE(rig.run_job(first));
  ASSERT_TRUE(rig.run_job(second, 1s));
  EXPECT_TRUE(second.done());
  EXPECT_EQ(calls, 1);
  first.when_finished([&] { ++calls; });
  EXPECT_EQ(calls, 2);
}

TEST(ParameterJob, FailsWhenTheSessionEnds) {
  Job<ParameterResult> job;
  Job<LoadReport> load;
  {
    Rig rig;
    rig.fcu.silent = true;
    job = rig.session.parameters().set("P001", 4.0);
    job.when_finished([job] { static_cast<void>(job); });  // holds itself: must not leak
    load = rig.session.parameters().load({{"P002", ParameterValue::of(1.0f)}});
    rig.run_for(100ms);
  }
  EXPECT_TRUE(job.failed());
  EXPECT_EQ(job.text(), "P001: the session has ended");
  EXPECT_TRUE(load.failed());
}

TEST(ParameterUnsaved, FollowsChangesAndWrites) {
  Rig rig;
  ASSERT_TRUE(rig.run_until([&] { return rig.session.parameters().complete(); }));
  EXPECT_FALSE(rig.session.parameters().unsaved());
  rig.fcu.set_from_inside("P001", ParameterValue::of(77.0f));
  rig.step();
  EXPECT_TRUE(rig.session.parameters().unsaved());
  // A change that comes while the write is on its way may have missed it.
  rig.fcu.on_command = [&](link::Command command) -> std::optional<bool> {
    if (command == link::Command::kWriteParams) {
      rig.fcu.set_from_inside("P002", ParameterValue::of(78.0f));
    }
    return true;
  };
  auto write = rig.session.commands().start(link::Command::kWriteParams);
  ASSERT_TRUE(rig.run_job(write));
  EXPECT_TRUE(rig.session.parameters().unsaved());
  rig.fcu.on_command = nullptr;
  write = rig.session.commands().start(link::Command::kWriteParams);
  ASSERT_TRUE(rig.run_job(write));
  EXPECT_TRUE(write.done());
  EXPECT_FALSE(rig.session.parameters().unsaved());
  EXPECT_EQ(rig.log.of<UnsavedEvent>().size(), 2U);
}

}  // namespace
}  // namespace rosflight::companion::test
