// SPDX-License-Identifier: BSD-3-Clause
// What a browser makes of it is tested in web/test/report.browser.test.ts.
#include "flight/flight_page.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "flight/flight_recorder.hpp"
#include "log/topic_kinds.hpp"

namespace rosflight::flight {
namespace {

namespace fs = std::filesystem;

class FlightPageTest : public testing::Test {
 protected:
  FlightPageTest() {
    fs::create_directories(folder_);
    std::ofstream(built_) << "<p>before\n<!-- flight -->\nafter</p>\n";
  }
  ~FlightPageTest() override { fs::remove_all(folder_); }

  std::string report() const {
    std::ifstream in(folder_ / "report.html");
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path folder_ = fs::temp_directory_path() / ("flight_page_test_" + std::to_string(::getpid()));
  fs::path built_ = folder_ / "page.html";
};

TEST_F(FlightPageTest, TheFlightTakesThePlaceOfTheLineAndNothingElseStays) {
  FlightPage page(built_, folder_, {});
  page.observer().on_logged(log::Topic::kTexts, 1, {});
  page.write("{\"a\":1}", "{}");
  const std::string html = report();
  EXPECT_EQ(
      html.rfind("<p>before\n<script type=\"application/json\" id=\"flight-summary\">{\"a\":1}", 0),
      0U);
  EXPECT_TRUE(html.ends_with("</script>\n\nafter</p>\n"));
  // A gzip file begins with 1f 8b 08.
  EXPECT_NE(html.find("id=\"flight-log\">H4sI"), std::string::npos);
}

TEST_F(FlightPageTest, ATextCannotEndItsElement) {
  FlightPage page(built_, folder_, {});
  page.write(R"({"mission":"</script><script>alert(1)</script>"})", "{}");
  EXPECT_NE(report().find(R"({"mission":"<\/script><script>alert(1)<\/script>"})"),
            std::string::npos);
}

TEST_F(FlightPageTest, AFlightThatBreaksOffLeavesNothing) {
  {
    FlightPage page(built_, folder_, {});
    page.observer().on_logged(log::Topic::kTexts, 1, {});
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(FlightPageTest, AnotherPageIsRefused) {
  std::ofstream(built_) << "<p>no place</p>";
  FlightPage page(built_, folder_, {});
  EXPECT_THROW(page.write("{}", "{}"), std::runtime_error);
  EXPECT_FALSE(fs::exists(folder_ / "report.html"));
}

/// What analysis.json has, of a flight of the fixed wing.
TEST_F(FlightPageTest, TheAnalysisHasCurvesWaypointsAndChangedParameters) {
  FlightChoice choice;
  choice.vehicle = "anaconda";
  const auto setup = std::make_unique<FlightSetup>(choice);
  const auto flight = std::make_unique<Flight>(*setup);
  FlightRecorder recorder(*flight, {}, LogLevel::kNone);
  while (!flight->finished() && sim::to_seconds(flight->now()) < 40.0) flight->step();
  recorder.close();
  const auto json = nlohmann::json::parse(analysis_json(*setup, recorder.analysis()));
  const auto& curves = json["curves"];
  EXPECT_NEAR(static_cast<double>(curves["t_s"].size()), 400.0, 2.0);
  for (const char* name :
       {"drift_north_m", "drift_east_m", "cross_track_m", "airspeed_command_m_s", "elevator"}) {
    ASSERT_TRUE(curves.contains(name)) << name;
    EXPECT_EQ(curves[name].size(), curves["t_s"].size()) << name;
  }
  EXPECT_GT(json["waypoints"].size(), 3U);
  EXPECT_EQ(json["waypoints"][0]["position_m"].size(), 3U);
  EXPECT_GT(json["changed_parameters"].size(), 3U);
  EXPECT_GT(json["gyro"]["frequency_Hz"].size(), 100U);
}

}  // namespace
}  // namespace rosflight::flight
