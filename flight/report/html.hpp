// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <string_view>

/// Text and numbers for HTML and SVG. Independent of the locale.
namespace rosflight::report {

/// Safe between tags and in attributes, whatever it contains: valid UTF-8, & < > " ' as entities.
std::string escape(std::string_view text);

/// Fixed-point, "-" without digits never, a dash for NaN and infinity, exponents past 1e9.
std::string number(double value, int decimals);

/// A coordinate: hundredths at most, no trailing zeros. Values past +-1e6 and NaN are cut to that
/// range.
void append_coordinate(std::string& out, double value);

}  // namespace rosflight::report
