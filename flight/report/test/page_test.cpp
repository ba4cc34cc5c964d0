// SPDX-License-Identifier: BSD-3-Clause
// That pages parse is checked by test_report_is_well_formed.py.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "flight/report/path_chart.hpp"
#include "flight/report/report.hpp"
#include "flight/report/svg_chart.hpp"
#include "flight/report/test/odd_flights.hpp"
#include "flight/report/test/synthetic_flight.hpp"
#include "flight/report/timeline.hpp"
#include "log/output_file.hpp"

namespace rosflight::report {
namespace {

constexpr double kImuInterval_s = 0.0025;

std::size_t count(const std::string& text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + part.size()))
    ++found;
  return found;
}

TEST(Report, SameFlightSamePage) {
  EXPECT_EQ(report_html(synthetic_flight(0.01)), report_html(synthetic_flight(0.01)));
}

TEST(Report, NamesNoPlaceOutside) {
  const std::string html = report_html(synthetic_flight(0.1));
  for (const char* part : {"http", "src=", "href=", "url(", "@import", "fetch(", "XMLHttp"}) {
    EXPECT_EQ(html.find(part), std::string::npos) << part;
  }
}

TEST(Report, SizeDependsOnTheWidthOfChartsNotOnTheSamples) {
  const std::size_t coarse = report_html(synthetic_flight(0.02)).size();
  const std::size_t fine = report_html(synthetic_flight(kImuInterval_s)).size();
  EXPECT_LT(fine, 1'500'000U);
  EXPECT_LT(fine, 2 * coarse);  // Eight times the samples.
}

TEST(Report, HasEverythingAsked) {
  const std::string html = report_html(synthetic_flight(0.1));
  for (const char* part :
       {"From above", "From the south", "Roll rate", "Motor outputs", "Rotor speeds",
        "Battery voltage", "Battery current", "Distance from setpoint", "RC lost: failsafe",
        "offboard, angles", "PRIMARY_MIXER", "flight.mcap", "./rosflight fly --vehicle",
        "RC silent", "class=\"badge bad\">missed"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
}

TEST(Report, ShowsWhatTheFirmwareCountedAndHowItFilteredTheGyro) {
  FlightRecord record = synthetic_flight(0.1);
  const std::string html = report_html(record);
  for (const char* part : {"Longest pass, µs", ">431<", "10 to 30 µs", "IMU: stuck",
                           "Gyro, density by frequency", "1.07 ms"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
  record.counters.reset();
  record.gyro = {};
  EXPECT_EQ(report_html(record).find("<h2>Firmware</h2>"), std::string::npos);
}

TEST(Report, ASpectrumOfNothingStillDraws) {
  FlightRecord record;
  record.gyro.frequency_Hz = {1.0, 2.0};
  record.gyro.before = {0.0, 0.0};
  record.gyro.after = {std::numeric_limits<double>::quiet_NaN(), 1e300};
  const std::string html = report_html(record);
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html.find("inf\""), std::string::npos);
}

TEST(Report, OddFlightsHaveAPageToo) {
  for (const std::string_view kind : kOddFlights) {
    const std::string html = report_html(odd_flight(kind));
    EXPECT_LT(html.size(), 1'500'000U) << kind;
    EXPECT_EQ(html.find("nan"), std::string::npos) << kind;
    EXPECT_EQ(html.find("\"inf"), std::string::npos) << kind;
    EXPECT_NE(html.find("</html>"), std::string::npos) << kind;
    EXPECT_FALSE(path_svg(odd_flight(kind)).empty()) << kind;
  }
}

TEST(Report, ThousandsOfEventsAreCutShortAndSaidSo) {
  const std::string html = report_html(odd_flight("chatter"));
  EXPECT_EQ(count(html, "<path class=\"event"), kMostEvents);
  EXPECT_NE(html.find("and 19500 more, which the log has."), std::string::npos);
  EXPECT_LT(count(html, "class=\"band"), 1100U);  // One a pixel.
}

TEST(Report, AnUnwritablePlaceIsOneLine) {
  try {
    write_report(FlightRecord{}, "/nowhere/report.html");
    FAIL();
  } catch (const log::LogError& error) {
    EXPECT_STREQ(error.what(),
                 "/nowhere/report.html.part: cannot create: No such file or directory");
  }
}

TEST(TimeChart, ACurveWithoutValuesIsLeftOutAndAnEmptyChartSaysSo) {
  const FlightRecord record = synthetic_flight(0.1);
  TimeChart chart({"Something", "m", 1.0, 2, {}, {}}, record);
  chart.add("nothing", CurveStyle::kCommand, [](const Sample&) { return kNone; });
  std::string empty;
  chart.append_to(empty);
  EXPECT_NE(empty.find("no data"), std::string::npos);
  EXPECT_EQ(count(empty, "class=\"curve"), 0U);

  chart.add("height", CurveStyle::kActual, [](const Sample& s) { return -s.p_W_m[2]; });
  std::string html;
  chart.append_to(html);
  EXPECT_EQ(html.find("no data"), std::string::npos);
  EXPECT_EQ(count(html, "class=\"curve"), 1U);
  EXPECT_EQ(html.find(">nothing<"), std::string::npos);
}

TEST(Report, ShowsTheEstimateOnlyOfAFlightOnOne) {
  FlightRecord record = synthetic_flight(0.1);
  const std::string with = report_html(record);
  for (const char* part :
       {"Position error, north", "Velocity error, down", "±3 σ", "GNSS position", ">planned<"}) {
    EXPECT_NE(with.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(count(with, "class=\"shade\""), 9U);          // three times three errors
  EXPECT_EQ(with.find(">sideslip<"), std::string::npos);  // an aid that was not used
  record.estimated = false;
  EXPECT_EQ(report_html(record).find("Position error, north"), std::string::npos);
}

TEST(Report, AFixedWingHasChartsOfItsOwn) {
  FlightRecord record(0.0);
  record.fixed_wing = true;
  for (int k = 0; k < 20; ++k) {
    Sample sample;
    sample.t_s = k;
    sample.wing.cross_track_m = 0.1F * static_cast<float>(k);
    sample.wing.course_rad = 3.1F;
    record.add(sample);
  }
  const std::string html = report_html(record);
  for (const char* part : {"Cross-track error", "Height above the ramped reference", "Airspeed",
                           "Course over ground", "Wind, to the north", "Surfaces, by effect"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
}

TEST(TimeChart, ABandLiesBeneathAndItsWidestPartMayBeCutOff) {
  FlightRecord record(0.0);
  std::vector<double> low;
  std::vector<double> high;
  for (int k = 0; k < 100; ++k) {
    Sample sample;
    sample.t_s = k;
    record.add(sample);
    high.push_back(k < 3 ? 1000.0 : 1.0);
    low.push_back(-high.back());
  }
  TimeChart chart({"Band", "m", 1.0, 2, {}, {}}, record);
  chart.add_band("sure", low, high);
  chart.add("x", CurveStyle::kActual, std::vector<double>(100, 0.5));
  std::string html;
  chart.append_to(html);
  EXPECT_LT(html.find("class=\"shade\""), html.find("class=\"curve actual\""));
  EXPECT_EQ(count(html, "class=\"shade\""), 1U);
  EXPECT_EQ(html.find(">1000<"), std::string::npos);  // no tick out there
}

TEST(TimeChart, PastAFixedRangeTheCurveRunsAlongTheEdge) {
  FlightRecord record(0.0);
  for (const float value : {0.5F, 7.0F, -7.0F, 0.5F}) {
    Sample sample;
    sample.t_s = static_cast<double>(record.samples().size());
    sample.battery_V = value;
    record.add(sample);
  }
  TimeChart chart({"Fixed", "", 1.0, 2, 0.0, 1.0}, record);
  chart.add("x", CurveStyle::kActual, [](const Sample& s) { return s.battery_V; });
  std::string html;
  chart.append_to(html);
  // The plot is 8..134 high and 48..552 wide; three seconds.
  EXPECT_NE(html.find("d=\"M48 71L216 8L384 134L552 71\""), std::string::npos) << html;
}

TEST(PathChart, AMetreIsAsLongAcrossAsItIsHigh) {
  FlightRecord record(0.0);
  for (const auto& [n, e] : {std::pair{0.0F, 0.0F}, {10.0F, 0.0F}, {10.0F, 10.0F}, {0.0F, 10.0F}}) {
    Sample sample;
    sample.t_s = static_cast<double>(record.samples().size());
    sample.p_W_m = {n, e, 0.0F};
    record.add(sample);
  }
  std::string svg;
  append_path_svg(svg, record, kFromAbove);
  const std::size_t at = svg.find("class=\"curve actual\" d=\"M");
  ASSERT_NE(at, std::string::npos);
  double x[4] = {};
  double y[4] = {};
  ASSERT_EQ(
      std::sscanf(svg.c_str() + at, "class=\"curve actual\" d=\"M%lf %lfL%lf %lfL%lf %lfL%lf %lf",
                  x, y, x + 1, y + 1, x + 2, y + 2, x + 3, y + 3),
      8);
  EXPECT_NEAR(x[2] - x[1], y[0] - y[1], 0.02);  // East to the right, north upwards, equally long.
  EXPECT_GT(x[2] - x[1], 100.0);
}

TEST(PathChart, WaypointsOnTheSameSpotShareALabel) {
  const FlightRecord record = synthetic_flight(0.1);
  std::string svg;
  append_path_svg(svg, record, kFromAbove);
  EXPECT_NE(svg.find(">1 7</text>"), std::string::npos);
  EXPECT_NE(svg.find("waypoint 5 missed"), std::string::npos);
}

}  // namespace
}  // namespace rosflight::report
