// SPDX-License-Identifier: BSD-3-Clause
// Writes the report and the picture of a made-up flight, to look at and for
// test_report_is_well_formed.py: report_sample FOLDER [KIND], KIND being one of odd_flights.hpp.
#include <exception>
#include <filesystem>
#include <iostream>

#include "flight/report/path_chart.hpp"
#include "flight/report/report.hpp"
#include "flight/report/test/odd_flights.hpp"
#include "flight/report/test/synthetic_flight.hpp"
#include "log/output_file.hpp"

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: report_sample FOLDER [KIND]\n";
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    constexpr double kEverySample_s = 0.0025;
    const auto record = argc > 2 ? rosflight::report::odd_flight(argv[2])
                                 : rosflight::report::synthetic_flight(kEverySample_s);
    rosflight::report::write_report(record, folder / "report.html");
    rosflight::base::write_file(folder / "path.svg", rosflight::report::path_svg(record));
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
  return 0;
}
