// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle/parameter_pages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "autonomy/estimation/read_estimator.hpp"
#include "autonomy/fixedwing/config.hpp"
#include "autonomy/multirotor/config.hpp"
#include "config/table.hpp"
#include "sim/parameter_tables.hpp"

namespace rosflight::flight {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(ParameterPages, DocumentsAndDefaultFilesAreThoseOfTheTables) {
  for (const auto& page : parameter_pages()) {
    EXPECT_TRUE(contents(page.path) == page.text)
        << page.path << " differs: run the program parameter_pages in the root of the sources";
  }
}

// ---- a list that was written down before the tables were ----------------------------------------

struct Listed {
  std::string fallback, low, high;
};
using List = std::map<std::string, Listed>;

List listed(const std::string& file, const std::string& table) {
  List list;
  std::istringstream lines(contents(file));
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string name, key;
    Listed row;
    std::getline(cells, name, ',');
    std::getline(cells, key, ',');
    std::getline(cells, row.fallback, ',');
    std::getline(cells, row.low, ',');
    std::getline(cells, row.high, ',');
    if (name == table) list[key] = row;
  }
  return list;
}

/// Documents round to three digits.
void expect_default(const config::detail::Row& row, const std::vector<double>& values,
                    const std::string& text) {
  using Kind = config::detail::Row::Kind;
  if (text == "-") {
    EXPECT_TRUE(values.empty()) << row.key;
    return;
  }
  ASSERT_FALSE(values.empty()) << row.key;
  if (row.kind == Kind::kChoice) {
    EXPECT_EQ(row.words.at(static_cast<std::size_t>(values[0])), text) << row.key;
  } else if (row.kind == Kind::kBoolean) {
    EXPECT_EQ(values[0] != 0.0, text == "true") << row.key;
  } else {
    const double number = std::stod(text);
    for (const double value : values)
      EXPECT_NEAR(value, number, 0.015 * std::abs(number)) << row.key;
  }
}

void expect_range(const config::detail::Row& row, const Listed& list) {
  if (list.low != "derived" && list.low != "-" && !row.limits) {
    const bool open = list.low.front() == '>';
    EXPECT_EQ(row.allowed.low, std::stod(list.low.substr(open ? 1 : 0))) << row.key;
    EXPECT_EQ(row.allowed.low_open, open) << row.key;
  }
  if (list.high != "derived" && list.high != "-" && !row.limits) {
    EXPECT_EQ(row.allowed.high, std::stod(list.high)) << row.key;
  }
  if (list.high == "-" && list.low != "-") {
    EXPECT_TRUE(std::isinf(row.allowed.high)) << row.key;
  }
  EXPECT_EQ(static_cast<bool>(row.limits), list.low == "derived" || list.high == "derived")
      << row.key;
}

/// What a section without keys is read as.
template <class S>
S defaults_of(const config::Table<S>& table) {
  S s;
  table.read(config::Document::from_text("{}", "empty").root(), s);
  return s;
}

template <class S>
void expect_as_listed(const config::Table<S>& table, const List& list) {
  const S defaults = defaults_of(table);
  std::size_t found = 0;
  for (const auto& parameter : table.parameters()) {
    const auto row = list.find(parameter.row.key);
    ASSERT_NE(row, list.end()) << parameter.row.key;
    expect_default(parameter.row, parameter.get(defaults), row->second.fallback);
    expect_range(parameter.row, row->second);
    ++found;
  }
  EXPECT_EQ(found, list.size());
}

template <class S>
void expect_ranges_as_listed(const config::Table<S>& table, const List& list) {
  std::size_t found = 0;
  for (const auto& parameter : table.parameters()) {
    const auto row = list.find(parameter.row.key);
    ASSERT_NE(row, list.end()) << parameter.row.key;
    expect_range(parameter.row, row->second);
    EXPECT_EQ(parameter.row.needed, row->second.fallback == "needed") << parameter.row.key;
    if (!parameter.row.needed && row->second.fallback != "-")
      expect_default(parameter.row, parameter.get(S{}), row->second.fallback);
    ++found;
  }
  EXPECT_EQ(found, list.size());
}

const std::string kList = "flight/vehicle/test/keys.csv";

TEST(ParameterTables, HaveTheKeysDefaultsAndRangesOfTheIndependentList) {
  expect_as_listed(autonomy::multirotor::parameters(), listed(kList, "multirotor"));
  expect_as_listed(autonomy::fixedwing::parameters(), listed(kList, "fixedwing"));
  expect_as_listed(autonomy::estimation::parameters(), listed(kList, "estimator"));
  expect_ranges_as_listed(sim::environment_parameters(), listed(kList, "environment"));
}

/// Every bound of every number, just outside, is refused in one line that names the key.
template <class S>
void expect_refusals(const config::Table<S>& table) {
  using Kind = config::detail::Row::Kind;
  for (const auto& parameter : table.parameters()) {
    const config::detail::Row& row = parameter.row;
    if (row.limits || (row.kind != Kind::kNumber && row.kind != Kind::kNumbers)) continue;
    for (const double bad : {row.allowed.low_open ? row.allowed.low : row.allowed.low - 1e-3,
                             row.allowed.high + 1e-3}) {
      if (std::isinf(bad)) continue;
      std::string value = config::number_text(bad);
      if (row.kind == Kind::kNumbers) value.insert(0, "[").append(", 0, 0]");
      auto document = config::Document::from_text("{}", "file.yaml");
      document.set(row.key + "=" + value);
      // Gains and curves: the keys that must be there stand before it.
      const std::string group = row.key.substr(0, row.key.rfind('.') + 1);
      for (const auto& other : table.parameters()) {
        if (other.row.needed && other.row.key != row.key && other.row.key.rfind(group, 0) == 0 &&
            !group.empty())
          document.set(other.row.key + "=0.5");
      }
      std::string message = "accepted";
      try {
        S s;
        table.read(document.root(), s);
      } catch (const config::Error& error) {
        message = error.what();
      }
      EXPECT_NE(message.find(row.key), std::string::npos) << row.key << ": " << message;
      EXPECT_NE(message.find("found"), std::string::npos) << message;
      EXPECT_NE(message.find("allowed a"), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
}

TEST(ParameterTables, ValuesBesideEveryRangeAreRefusedInOneLine) {
  expect_refusals(autonomy::multirotor::parameters());
  expect_refusals(autonomy::fixedwing::parameters());
  expect_refusals(autonomy::estimation::parameters());
}

TEST(ParameterTables, ReadTheFormerKeyOfTheTimeOfRejectedVelocity) {
  autonomy::estimation::EstimatorConfig s;
  const auto document = config::Document::from_text("gnss_doubt_s: 0.7", "file.yaml");
  autonomy::estimation::parameters().read(document.root(), s);
  EXPECT_EQ(s.gnss_rejected_s, 0.7);
}

TEST(ParameterTables, ReadTheFormerKeyOfTheMaximumRange) {
  autonomy::fixedwing::AutonomyConfig s;
  const auto document = config::Document::from_text("safety: {longest_range_m: 5}", "file.yaml");
  autonomy::fixedwing::parameters().read(document.root(), s);
  EXPECT_EQ(s.flight.safety.max_range_m, 5.0);
}

template <class S>
S read_default_file(const std::string& file, const config::Table<S>& table) {
  S s;
  const auto document = config::Document::from_file(file);
  const auto autonomy = document.root().section("autonomy");
  table.read(autonomy, s);
  autonomy::estimation::read_estimator(autonomy.foreign_section("estimator"), {});
  autonomy.finish();
  return s;
}

TEST(ParameterPages, DefaultFilesLoadToTheDefaults) {
  const auto multirotor = autonomy::multirotor::parameters();
  EXPECT_EQ(multirotor.write(read_default_file("vehicles/defaults/multirotor.yaml", multirotor)),
            multirotor.write(defaults_of(multirotor)));
  const auto fixedwing = autonomy::fixedwing::parameters();
  EXPECT_EQ(fixedwing.write(read_default_file("vehicles/defaults/fixedwing.yaml", fixedwing)),
            fixedwing.write(defaults_of(fixedwing)));
}

TEST(ParameterPages, EveryKeyHasARowInThePage) {
  const std::string page = contents("docs/autonomy-keys.md");
  const auto expect_listed = [&page](const auto& table) {
    for (const auto& parameter : table.parameters()) {
      const std::string& key = parameter.row.key;
      const std::string in_section =
          key.substr(key.find('.') == std::string::npos ? 0 : key.find('.') + 1);
      EXPECT_NE(page.find("| `" + in_section + "` |"), std::string::npos) << key;
    }
  };
  expect_listed(autonomy::multirotor::parameters());
  expect_listed(autonomy::fixedwing::parameters());
  expect_listed(autonomy::estimation::parameters());
}

}  // namespace
}  // namespace rosflight::flight
