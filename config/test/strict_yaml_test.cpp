// SPDX-License-Identifier: BSD-3-Clause
#include "config/strict_yaml.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace rosflight::config {
namespace {

Document parse(const std::string& text) {
  return Document::from_text(text, "file.yaml");
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string message_of_file(const std::string& name, const std::string& bytes) {
  const auto file = std::filesystem::temp_directory_path() / ("strict_yaml_test_" + name);
  std::ofstream(file, std::ios::binary) << bytes;
  const std::string message = message_of([&] { Document::from_file(file); });
  std::filesystem::remove(file);
  const auto cut = message.find(name);
  return cut == std::string::npos ? message : message.substr(cut);
}

TEST(StrictYaml, ReadsWhatIsThere) {
  const Document document = parse(
      "body: {mass_kg: 3.5, name: 'quad', big: true}\n"
      "arms: [1, -.99, 2e-1, +4., .5]\n"
      "count: -12\n"
      "rotors:\n"
      "  - spin: 1\n"
      "  - spin: -1\n");
  const Section root = document.root();
  const Section body = root.section("body");
  EXPECT_EQ(body.number("mass_kg", Range::positive()), 3.5);
  EXPECT_EQ(body.text("name"), "quad");
  EXPECT_TRUE(body.boolean("big"));
  EXPECT_EQ(root.numbers("arms", 5, Range::any()),
            (std::vector<double>{1.0, -0.99, 0.2, 4.0, 0.5}));
  EXPECT_EQ(root.integer("count", -20, 20), -12);
  const auto rotors = root.sections("rotors");
  ASSERT_EQ(rotors.size(), 2U);
  EXPECT_EQ(rotors[0].number("spin", Range::between(-1, 1)), 1.0);
  EXPECT_EQ(rotors[1].number("spin", Range::between(-1, 1)), -1.0);
  EXPECT_NO_THROW(root.finish());
  EXPECT_EQ(root.keys(), (std::vector<std::string>{"body", "arms", "count", "rotors"}));
}

TEST(StrictYaml, ReadsRowsOfNumbers) {
  const Document document =
      parse("points: [[1, 2], [3, 4]]\nragged: [[1, 2], [3]]\nflat: [1, 2]\n");
  const Section root = document.root();
  EXPECT_EQ(root.rows("points", 2, Range::any()),
            (std::vector<std::vector<double>>{{1, 2}, {3, 4}}));
  EXPECT_EQ(message_of([&] { root.rows("ragged", 2, Range::any()); }),
            "file.yaml:2: ragged.1: found a list of 1, allowed a list of 2 numbers, each a number");
  EXPECT_EQ(message_of([&] { root.rows("flat", 2, Range::any()); }),
            "file.yaml:3: flat.0: found 1, allowed a list of 2 numbers, each a number");
}

TEST(StrictYaml, DefaultsStandForAbsentKeysOnly) {
  const Document document = parse("a: x\nkind: fast");
  const Section root = document.root();
  const Section::Choices<int> kinds = {{"slow", 1}, {"fast", 2}};
  EXPECT_EQ(root.number("b", Range::positive(), -7.0), -7.0);
  EXPECT_EQ(root.choice("kind", kinds), 2);
  EXPECT_EQ(root.choice("other", kinds, 1), 1);
  EXPECT_EQ(root.text("c", "none"), "none");
  EXPECT_FALSE(root.boolean("d", false));
  EXPECT_EQ(root.integer("e", 0, 5, 3), 3);
  EXPECT_FALSE(root.optional_section("f").has_value());
  EXPECT_EQ(message_of([&] { root.number("a", Range::positive(), 1.0); }),
            "file.yaml:1: a: found x, allowed a number > 0");
}

TEST(StrictYaml, NamesFileLineKeyFoundAndAllowed) {
  const Document document =
      parse("\nbody:\n  mass_kg: -3\n  unit: 3.5 kg\n  text: '7'\n  list: [1, 2, x]\n  kind: c\n");
  const Section root = document.root();
  const Section body = root.section("body");
  EXPECT_EQ(message_of([&] { body.number("mass_kg", Range::positive_up_to(1000)); }),
            "file.yaml:3: body.mass_kg: found -3, allowed a number > 0 and <= 1000");
  EXPECT_EQ(message_of([&] { body.number("unit", Range::at_least(0)); }),
            "file.yaml:4: body.unit: found 3.5 kg, allowed a number >= 0");
  EXPECT_EQ(message_of([&] { body.number("text", Range::between(0, 9)); }),
            "file.yaml:5: body.text: found \"7\", allowed a number from 0 to 9");
  EXPECT_EQ(message_of([&] { body.numbers("list", 3, Range::any()); }),
            "file.yaml:6: body.list.2: found x, allowed a number");
  EXPECT_EQ(
      message_of([&] { body.numbers("list", 2, Range::any()); }),
      "file.yaml:6: body.list: found a list of 3, allowed a list of 2 numbers, each a number");
  EXPECT_EQ(message_of([&] { body.number("missing", Range::any()); }),
            "file.yaml:2: body.missing: found nothing, allowed a number");
  EXPECT_EQ(message_of([&] { body.choice<int>("kind", {{"a", 1}, {"b", 2}}); }),
            "file.yaml:7: body.kind: found c, allowed a, b");
  EXPECT_EQ(message_of([&] { body.boolean("mass_kg"); }),
            "file.yaml:3: body.mass_kg: found -3, allowed true or false");
  EXPECT_EQ(message_of([&] { body.section("mass_kg"); }),
            "file.yaml:3: body.mass_kg: found -3, allowed a map");
  EXPECT_EQ(message_of([&] { body.integer("unit", 0, 3); }),
            "file.yaml:4: body.unit: found 3.5 kg, allowed an integer from 0 to 3");
  EXPECT_EQ(message_of([&] { body.sections("list"); }),
            "file.yaml:6: body.list.0: found 1, allowed a map");
  EXPECT_EQ(message_of([&] { throw body.error("kind", body.raw("kind"), "d"); }),
            "file.yaml:7: body.kind: found c, allowed d");
}

TEST(StrictYaml, RejectsKeysNobodyAskedFor) {
  const Document document = parse("body:\n  mass_kg: 1\n  mas_kg: 1\nsensors:\n  x: 1\n");
  const Section root = document.root();
  const Section body = root.section("body");
  body.number("mass_kg", Range::positive());
  body.number("drag", Range::positive(), 1.0);
  const Section sensors = root.foreign_section("sensors");
  EXPECT_EQ(message_of([&] { root.finish(); }),
            "file.yaml:3: body.mas_kg: found an unknown key, allowed mass_kg, drag");
  EXPECT_EQ(message_of([&] { sensors.finish(); }),
            "file.yaml:5: sensors.x: found an unknown key, allowed no keys here");
  EXPECT_TRUE(root.foreign_section("autonomy").keys().empty());
}

TEST(StrictYaml, RejectsDuplicateKeys) {
  EXPECT_EQ(message_of([] { parse("a: 1\nb:\n  c: 1\n  d: 2\n  c: 3\n"); }),
            "file.yaml:5: b.c: found the key again (first in line 3), allowed each key once");
}

TEST(StrictYaml, RejectsWhatIsNoYamlMap) {
  EXPECT_EQ(message_of([] { parse(""); }),
            "file.yaml:1: found an empty file, allowed a map or a list");
  EXPECT_EQ(message_of([] { parse("# only a comment\n"); }),
            "file.yaml:1: found an empty file, allowed a map or a list");
  EXPECT_EQ(message_of([] { parse("hello"); }),
            "file.yaml:1: found hello, allowed a map or a list");
  EXPECT_EQ(message_of([] { parse("a: 1\n---\nb: 1\n"); }),
            "file.yaml:1: found 2 documents, allowed one");
  EXPECT_EQ(message_of([] { parse("- 1\n").root(); }),
            "file.yaml:1: found a list of 1, allowed a map");
  EXPECT_EQ(message_of([] { parse("a: 1").root_sections(); }),
            "file.yaml:1: found a map, allowed a list of maps");
  EXPECT_EQ(parse("- {a: 1}\n- {a: 2}\n").root_sections().at(1).number("a", Range::any()), 2.0);
  EXPECT_EQ(message_of([] { parse("a: [1, 2\nb: 3\n"); }).substr(0, 38),
            "file.yaml:2: found broken YAML (end of");
  EXPECT_EQ(message_of([] { parse("a: !!python/object x\n"); }),
            "file.yaml:1: a: found the tag tag:yaml.org,2002:python/object, allowed no tags");
  EXPECT_EQ(message_of([] { parse("a.b: 1\n"); }),
            "file.yaml:1: a.b: found the key \"a.b\", allowed keys of 1 to 128 characters without "
            "dots and control characters");
}

/// Beyond 1024 characters YAML no longer takes a word for a key: what is written must be read
/// again.
TEST(StrictYaml, KeysHaveALongestLength) {
  const std::string longest(128, 'k');
  const std::string refused = "found the key \"" + std::string(60, 'k') + "...\"";
  EXPECT_NO_THROW(parse(longest + ": 1\n"));
  EXPECT_NE(message_of([&] { parse("? " + longest + "k\n: 1\n"); }).find(refused),
            std::string::npos);
  Document document = parse("a: 1\n");
  document.set(longest + "=1");
  EXPECT_EQ(parse(document.text()).text(), document.text());
  EXPECT_NE(message_of([&] { document.set(longest + "k=1"); }).find(refused), std::string::npos);
  EXPECT_NE(message_of([&] { document.set("a\rb=1"); }).find("the key \"a?b\""), std::string::npos);
}

TEST(StrictYaml, RejectsBinaryDeepAndExplodingText) {
  EXPECT_EQ(message_of([] { parse(std::string("a: 1\nb: \0\1\2", 11)); }),
            "file.yaml:2: found a control character (is this a binary file?), allowed YAML text");
  EXPECT_NE(message_of([] {
              parse("a: " + std::string(100, '[') + std::string(100, ']'));
            }).find("too deep"),
            std::string::npos);
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string name = std::to_string(i);
    bomb.append("a").append(name).append(": &a").append(name).append(" [");
    for (int k = 0; k < 8; ++k) bomb.append("*a").append(std::to_string(i - 1)).append(", ");
    bomb.append("]\n");
  }
  EXPECT_NE(message_of([&] { parse(bomb); }).find("too large"), std::string::npos);
}

TEST(StrictYaml, FilesThatCannotBeReadAreNamed) {
  EXPECT_EQ(message_of([] { Document::from_file("/nonexistent/x.yaml"); }),
            "/nonexistent/x.yaml: found no such file, allowed a YAML file");
  EXPECT_EQ(message_of([] { Document::from_file("/"); }),
            "/: found something that is no file, allowed a YAML file");
  EXPECT_EQ(message_of_file("empty.yaml", ""),
            "empty.yaml:1: found an empty file, allowed a map or a list");
  EXPECT_EQ(message_of_file("elf.yaml", std::string("\x7f"
                                                    "ELF\0\0\0",
                                                    7)),
            "elf.yaml:1: found a control character (is this a binary file?), allowed YAML text");
  EXPECT_EQ(message_of_file("long.yaml", std::string(Document::kMaxBytes + 1, ' ')),
            "long.yaml: found 4194305 bytes, allowed 4194304");
}

TEST(StrictYaml, OverridesReplaceAndAddValues) {
  Document document = parse("body: {mass_kg: 1, arm: [1, 2]}\n");
  document.set("body.mass_kg=-.5");
  document.set("body.arm.1=7");
  document.set("body.new.deep=[1, 2, 3]");
  const Section body = document.root().section("body");
  EXPECT_EQ(body.number("mass_kg", Range::any()), -0.5);
  EXPECT_EQ(body.numbers("arm", 2, Range::any()), (std::vector<double>{1.0, 7.0}));
  EXPECT_EQ(body.section("new").numbers("deep", 3, Range::any()),
            (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_NO_THROW(document.root().finish());
}

TEST(StrictYaml, OverridesMeetTheSameChecks) {
  Document document = parse("body: {mass_kg: 1, arm: [1, 2]}\n");
  EXPECT_EQ(message_of([&] { document.set("body"); }),
            "--set body: found no assignment, allowed key.sub=value");
  EXPECT_EQ(message_of([&] { document.set("body..x=1"); }),
            "--set body..x=1: found the key \"\", allowed keys of 1 to 128 characters without "
            "dots and control characters");
  EXPECT_EQ(message_of([&] { document.set("body.mass_kg="); }),
            "--set body.mass_kg=: body.mass_kg: found nothing, allowed a value");
  EXPECT_EQ(message_of([&] { document.set("body.mass_kg.x=1"); }),
            "--set body.mass_kg.x=1: body.mass_kg.x: found the value 1 at body.mass_kg, allowed a "
            "map or a list");
  EXPECT_EQ(message_of([&] { document.set("body.arm.2=1"); }),
            "--set body.arm.2=1: body.arm.2: found no such entry, allowed one of 2 counted from 0");
  std::string deep = "other";
  for (int i = 0; i < 40; ++i) deep += ".a";
  EXPECT_NE(message_of([&] { document.set(deep + "=1"); }).find("too deep"), std::string::npos);
  document.set("body.mass_kg=-1");
  document.set("body.mas=2", "--tweak");
  const Section root = document.root();
  const Section body = root.section("body");
  EXPECT_EQ(message_of([&] { body.number("mass_kg", Range::positive()); }),
            "--set body.mass_kg=-1: body.mass_kg: found -1, allowed a number > 0");
  body.numbers("arm", 2, Range::any());
  EXPECT_EQ(message_of([&] { root.finish(); }),
            "--tweak body.mas=2: body.mas: found an unknown key, allowed mass_kg, arm");
}

TEST(StrictYaml, MergingReplacesValuesAndKeepsTheirPlaces) {
  Document base = Document::from_text("a: {x: 1, y: [1, 2]}\nb: 5\n", "base.yaml");
  base.merge(Document::from_text("\na: {y: [7], z: -1}\nc: {d: 1}\n", "over.yaml"));
  const Section root = base.root();
  const Section a = root.section("a");
  EXPECT_EQ(a.number("x", Range::any()), 1.0);
  EXPECT_EQ(a.numbers("y", 1, Range::any()), std::vector<double>{7.0});
  EXPECT_EQ(message_of([&] { a.number("z", Range::positive()); }),
            "over.yaml:2: a.z: found -1, allowed a number > 0");
  EXPECT_EQ(message_of([&] { root.number("b", Range::between(0, 1)); }),
            "base.yaml:2: b: found 5, allowed a number from 0 to 1");
  EXPECT_EQ(root.section("c").number("d", Range::any()), 1.0);
}

/// Files are parsed once: what is done to one document must not show in the next one of the same file.
TEST(StrictYaml, AFileReadAgainIsWhatTheFileSays) {
  const auto file = std::filesystem::temp_directory_path() / "strict_yaml_test_again.yaml";
  const auto write = [&file](const std::string& text) { std::ofstream(file) << text; };
  write("a: 1\nb: {c: 2}\n");
  Document first = Document::from_file(file);
  first.set("b.c=9");
  first.remove("a");
  EXPECT_EQ(first.root().keys(), std::vector<std::string>{"b"});

  const Document second = Document::from_file(file);
  EXPECT_EQ(second.root().number("a", Range::any()), 1.0);
  EXPECT_EQ(second.root().section("b").number("c", Range::any()), 2.0);
  second.root().finish();
  EXPECT_EQ(message_of([&] {
              const Section root = Document::from_file(file).root();
              static_cast<void>(root.number("a", Range::any()));
              root.finish();
            }),
            file.string() + ":2: b: found an unknown key, allowed a");

  write("a: 1\nb: {c: 3}\n");
  EXPECT_EQ(Document::from_file(file).root().section("b").number("c", Range::any()), 3.0);
  write("a: [1\n");
  EXPECT_NE(message_of([&] { Document::from_file(file); }), "no error");
  std::filesystem::remove(file);
  EXPECT_NE(message_of([&] { Document::from_file(file); }).find("no such file"), std::string::npos);
}

TEST(StrictYaml, ThreadsReadTheSameFile) {
  const auto file = std::filesystem::temp_directory_path() / "strict_yaml_test_threads.yaml";
  std::ofstream(file) << "a: 1\n";
  std::vector<std::thread> threads;
  std::atomic<int> right{0};
  constexpr int kThreads = 4;
  constexpr int kReads = 100;
  threads.reserve(kThreads);
  for (int k = 0; k < kThreads; ++k) {
    threads.emplace_back([&] {
      for (int n = 0; n < kReads; ++n) {
        right += Document::from_file(file).root().integer("a", 0, 1) == 1 ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, kThreads * kReads);
  std::filesystem::remove(file);
}

TEST(StrictYaml, NumbersAreDecimalAndFinite) {
  EXPECT_EQ(parse_number("-.99"), -0.99);
  EXPECT_EQ(parse_number("1e-3"), 1e-3);
  EXPECT_EQ(parse_number("5."), 5.0);
  EXPECT_EQ(parse_number("+2"), 2.0);
  for (const char* bad :
       {"", ".", "-", "+-1", "nan", ".inf", "inf", "0x10", "1e999", "1,5", "1 ", "1_000", "12h"}) {
    EXPECT_FALSE(parse_number(bad).has_value()) << bad;
  }
}

TEST(StrictYaml, NumbersAreShownShort) {
  EXPECT_EQ(number_text(100000.0), "100000");
  EXPECT_EQ(number_text(-0.1), "-0.1");
  EXPECT_EQ(number_text(0.0), "0");
  EXPECT_EQ(number_text(1e-5), "1e-05");
  EXPECT_EQ(number_text(1e300), "1e+300");
}

TEST(StrictYaml, WrittenTextReadsBackTheSame) {
  const std::string text =
      "a: 1.50\nb:\n  - {x: 'quo\"ted', y: []}\n  - {x: \"no: yes\", z: {}}\nlist: [1, [2, 3], two "
      "words]\nnothing:\n";
  const Document document = parse(text);
  const std::string written = document.text();
  const Document again = Document::from_text(written, "again");
  EXPECT_EQ(again.text(), written);
  EXPECT_EQ(parse("{}").text(), "{}\n");
  EXPECT_EQ(parse("[]").text(), "[]\n");
  const Section first = again.root().sections("b").at(0);
  EXPECT_EQ(first.text("x"), "quo\"ted");
  EXPECT_EQ(again.root().sections("b").at(1).text("x"), "no: yes");
  EXPECT_EQ(again.root().number("a", Range::any()), 1.5);
}

}  // namespace
}  // namespace rosflight::config
