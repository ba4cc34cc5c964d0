// SPDX-License-Identifier: BSD-3-Clause
#include "config/table.hpp"

#include <gtest/gtest.h>

#include <array>

namespace rosflight::config {
namespace {

enum class Shape { kRound, kSquare };

struct Gains {
  double kp{}, ki{};
};

struct Curve {
  double a{}, b{};
};

struct Settings {
  double tilt_rad{0.5};
  double slow_m_s{2.0};
  double fast_m_s{5.0};
  std::array<double, 3> position_m{1.0, 2.0, 3.0};
  int count{4};
  bool enabled{true};
  Shape shape{Shape::kRound};
  std::optional<double> declination_rad;
  Gains gains{3.0, 1.0};
  std::optional<Curve> curve;
  double period_s{0.02};
  std::vector<double> levels;
  std::vector<double> corners;  ///< x, y, z of each
  std::vector<Curve> curves;
};

Table<Settings> table() {
  using S = Settings;
  using R = Row<S>;
  const Table<Gains> gains = Table<Gains>{
      Row<Gains>{"kp", &Gains::kp, "", Range::between(0.0, 100.0), "first"}.needed(),
      {"ki", &Gains::ki, "", Range::between(0.0, 100.0),
       "second"}}.whole();
  const Table<Curve> curve{Row<Curve>{"a", &Curve::a, "V", Range::positive(), ""}.needed(),
                           Row<Curve>{"b", &Curve::b, "V", Range::positive(), ""}.needed()};
  const Table<S> motion{
      {"tilt_deg", &S::tilt_rad, kDeg, Range::between(1.0, 60.0), "largest tilt"},
      R{"slow_m_s", &S::slow_m_s, "m/s", Range::between(0.1, 50.0), "slow"}.must(
          "less than fast_m_s", [](const S& s) { return s.slow_m_s < s.fast_m_s; }),
      R{"fast_m_s", &S::fast_m_s, "m/s", Range::between(0.1, 50.0), "fast"}
          .derived("2.5 slow_m_s", [](S& s) { s.fast_m_s = 2.5 * s.slow_m_s; })
          .within("slow_m_s to 50", [](const S& s) { return Range::between(s.slow_m_s, 50.0); })};
  return {
      {"motion", [](S& s) -> S& { return s; }, motion, "How it moves."},
      R{"position_W_m", &S::position_m, "m", Range::between(-10.0, 10.0), "where"}.formerly(
          "position_N_m"),
      {"count", &S::count, "", Whole{0, 10}, "how many"},
      {"enabled", &S::enabled, "works at all"},
      {"shape",
       &S::shape,
       {{"round", Shape::kRound}, {"square", Shape::kSquare}},
       "seen from above"},
      R{"declination_deg", &S::declination_rad, kDeg, Range::between(-180.0, 180.0), "east"}
          .if_absent("from a model"),
      {"gains", &S::gains, gains, "of the loop"},
      {"curve", &S::curve, curve, "measured"},
      R{"rate_Hz", [](const S& s) { return 1.0 / s.period_s; },
        [](S& s, double rate) { s.period_s = 1.0 / rate; }, "Hz", Range::positive(), "how often"}
          .only("any number but 13", [](double v) { return v != 13.0; }),
      R{"levels", &S::levels, "m", Range::positive(), "rising"}
          .needed_if("with the shape square", [](const S& s) { return s.shape == Shape::kSquare; })
          .must("two or more", [](const S& s) { return s.levels.size() != 1; }),
      {"corners", Points{}, [](const S& s) { return s.corners; },
       [](S& s, const std::vector<double>& values) { s.corners = values; }, "m",
       Range::between(-5.0, 5.0), "of the area"},
      {"curves", &S::curves, curve, Whole{0, 2}, "of each phase"}};
}

Settings read(const std::string& text) {
  Settings s;
  const Document document = Document::from_text(text, "file.yaml");
  table().read(document.root(), s);
  document.root().finish();
  return s;
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Table, AbsentKeysLeaveTheDefaults) {
  const Settings s = read("{}");
  EXPECT_EQ(s.tilt_rad, 0.5);
  EXPECT_EQ(s.fast_m_s, 5.0);
  EXPECT_EQ(s.gains.kp, 3.0);
  EXPECT_FALSE(s.curve);
  EXPECT_FALSE(s.declination_rad);
}

TEST(Table, ReadsEveryKind) {
  const Settings s = read(
      "motion: {tilt_deg: 45, slow_m_s: 3}\n"
      "position_W_m: [4, 5, 6]\ncount: 7\nenabled: false\nshape: square\ndeclination_deg: 90\n"
      "gains: {kp: 2}\ncurve: {a: 1, b: 2}\nrate_Hz: 4\nlevels: [1, 2]\n"
      "corners: [[1, 2, 3], [4, 5, -5]]\ncurves: [{a: 1, b: 2}, {a: 3, b: 4}]\n");
  EXPECT_DOUBLE_EQ(s.tilt_rad, 0.78539816339744831);
  EXPECT_EQ(s.fast_m_s, 7.5) << "derived from what was read";
  EXPECT_EQ(s.position_m[2], 6.0);
  EXPECT_EQ(s.count, 7);
  EXPECT_FALSE(s.enabled);
  EXPECT_EQ(s.shape, Shape::kSquare);
  EXPECT_DOUBLE_EQ(s.declination_rad.value_or(0.0), 1.5707963267948966);
  EXPECT_EQ(s.gains.kp, 2.0);
  EXPECT_EQ(s.gains.ki, 0.0) << "gains that are there begin from 0";
  EXPECT_EQ(s.curve.value_or(Curve{}).b, 2.0);
  EXPECT_EQ(s.period_s, 0.25);
  EXPECT_EQ(s.levels, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(s.corners, (std::vector<double>{1.0, 2.0, 3.0, 4.0, 5.0, -5.0}));
  ASSERT_EQ(s.curves.size(), 2U);
  EXPECT_EQ(s.curves[1].b, 4.0);
}

TEST(Table, SwitchesHaveTheSpellingsOfYaml) {
  for (const char* text : {"enabled: true", "enabled: True", "enabled: TRUE"}) {
    EXPECT_TRUE(read(text).enabled) << text;
  }
  for (const char* text : {"enabled: false", "enabled: False", "enabled: FALSE"}) {
    EXPECT_FALSE(read(text).enabled) << text;
  }
}

TEST(Table, RefusalsNameFileLineKeyFoundAndAllowed) {
  EXPECT_EQ(refusal("motion:\n  tilt_deg: 61\n"),
            "file.yaml:2: motion.tilt_deg: found 61, allowed a number from 1 to 60");
  EXPECT_EQ(refusal("gains: {ki: 1}"),
            "file.yaml:1: gains.kp: found nothing, allowed a number from 0 to 100");
  EXPECT_EQ(refusal("curve: {a: 1}"), "file.yaml:1: curve.b: found nothing, allowed a number > 0");
  EXPECT_EQ(refusal("count: 11"), "file.yaml:1: count: found 11, allowed an integer from 0 to 10");
  EXPECT_EQ(refusal("shape: flat"), "file.yaml:1: shape: found flat, allowed round, square");
  EXPECT_EQ(refusal("enabled: 1"), "file.yaml:1: enabled: found 1, allowed true or false");
  EXPECT_EQ(refusal("enabled: tRUE"), "file.yaml:1: enabled: found tRUE, allowed true or false");
  EXPECT_EQ(refusal("enabled: 'True'").substr(0, 20), "file.yaml:1: enabled");
  EXPECT_EQ(refusal("position_W_m: [1, 2]").substr(0, 30), "file.yaml:1: position_W_m: fou");
  EXPECT_EQ(refusal("motion: {slow_m_s: 9, fast_m_s: 8}"),
            "file.yaml:1: motion.fast_m_s: found 8, allowed a number from 9 to 50");
  EXPECT_EQ(refusal("motion: {slow_m_s: 8, fast_m_s: 8}"),
            "file.yaml:1: motion.slow_m_s: found 8, allowed less than fast_m_s");
  EXPECT_EQ(refusal("rate_Hz: 13"), "file.yaml:1: rate_Hz: found 13, allowed any number but 13");
  EXPECT_EQ(refusal("shape: square"),
            "file.yaml:1: levels: found nothing, allowed a list of numbers, each a number > 0");
  EXPECT_EQ(refusal("levels: [3]"), "file.yaml:1: levels: found [3], allowed two or more");
  EXPECT_EQ(refusal("corners: [[1, 2, 6]]"),
            "file.yaml:1: corners.0.2: found 6, allowed a number from -5 to 5");
  EXPECT_EQ(refusal("curves: [{a: 1, b: 2}, {a: 1}]"),
            "file.yaml:1: curves.1.b: found nothing, allowed a number > 0");
  EXPECT_EQ(refusal("curves: [{}, {}, {}]"),
            "file.yaml:1: curves: found 3 entries, allowed 0 to 2");
  EXPECT_NE(refusal("motion: {tilt: 1}").find("motion.tilt: found an unknown key"),
            std::string::npos);
}

TEST(Table, FormerSpellingIsAcceptedAndTheLaterOneCounts) {
  EXPECT_EQ(read("position_N_m: [7, 8, 9]").position_m[0], 7.0);
  EXPECT_EQ(read("position_W_m: [1, 2, 3]\nposition_N_m: [4, 5, 6]").position_m[0], 4.0)
      << "an override in the former spelling";
  EXPECT_EQ(read("position_N_m: [1, 2, 3]\nposition_W_m: [4, 5, 6]").position_m[0], 4.0);
  EXPECT_NE(refusal("position_N_m: [11, 2, 3]").find("position_N_m.0: found 11"),
            std::string::npos);
  EXPECT_EQ(refusal("position_Nm: [1, 2, 3]").find("position_N_m"), std::string::npos)
      << "a former spelling is not proposed";
}

TEST(Table, WrittenFileReadsBackToTheBit) {
  Settings s = read(
      "motion: {tilt_deg: 33.3, slow_m_s: 0.7}\nshape: square\nlevels: [0.1, 3]\n"
      "gains: {kp: 0.1}\ncorners: [[1, 0.1, 2], [3, 4, 5]]\ncurves: [{a: 0.3, b: 2}]\n");
  s.declination_rad = 0.1;
  s.curve = Curve{1.0 / 3.0, 2.0};
  const Settings again = read(table().write(s));
  EXPECT_EQ(table().write(again), table().write(s));
  EXPECT_EQ(again.tilt_rad, s.tilt_rad);
  EXPECT_EQ(again.fast_m_s, s.fast_m_s);
  EXPECT_EQ(again.curve.value_or(Curve{}).a, 1.0 / 3.0);
  EXPECT_EQ(again.shape, s.shape);
  EXPECT_EQ(again.levels, s.levels);
  EXPECT_EQ(again.corners, s.corners);
  ASSERT_EQ(again.curves.size(), 1U);
  EXPECT_EQ(again.curves[0].a, 0.3);
}

TEST(Table, CommentedFileLoadsToTheDefaultsAndLeavesDerivedOnesDerived) {
  const std::string text = table().commented(Settings{});
  EXPECT_EQ(table().write(read(text)), table().write(Settings{}));
  EXPECT_NE(text.find("  # from 1 to 60 deg: largest tilt\n  tilt_deg: 28.6"), std::string::npos);
  EXPECT_NE(text.find("  # fast_m_s: 2.5 slow_m_s\n"), std::string::npos);
  EXPECT_NE(text.find("# declination_deg: from a model\n"), std::string::npos);
}

TEST(Table, PageListsEveryKey) {
  const std::string page = table().page(Settings{});
  for (const auto& parameter : table().parameters()) {
    const std::string& path = parameter.row.key;
    EXPECT_NE(page.find("| `" + path.substr(path.rfind('.') + 1) + "` |"), std::string::npos)
        << path;
  }
  EXPECT_NE(page.find("| `tilt_deg` | 28.6479 | deg | from 1 to 60 | largest tilt |"),
            std::string::npos);
  EXPECT_NE(page.find("| `curves[].a` | needed | V | > 0 |"), std::string::npos);
  EXPECT_NE(page.find("| `levels` | needed with the shape square | m | numbers, each > 0 | rising; "
                      "two or more |"),
            std::string::npos);
  EXPECT_NE(page.find("former spelling `position_N_m`"), std::string::npos);
}

TEST(Table, SingleParametersAreFoundByTheirPath) {
  Settings s;
  std::vector<std::string> keys;
  for (const auto& parameter : table().parameters()) {
    keys.push_back(parameter.row.key);
    if (parameter.row.key == "motion.tilt_deg") parameter.set(s, {30.0});
    if (parameter.row.key == "curve.b") {
      EXPECT_TRUE(parameter.get(s).empty());
      parameter.set(s, {4.0});
      EXPECT_EQ(parameter.get(s)[0], 4.0);
    }
  }
  EXPECT_DOUBLE_EQ(s.tilt_rad, 0.52359877559829882);
  EXPECT_EQ(keys.front(), "motion.tilt_deg");
  EXPECT_EQ(keys.size(), 15U) << "entries of a list are no single parameters";
}

}  // namespace
}  // namespace rosflight::config
