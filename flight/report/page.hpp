// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string_view>

/// The texts of colours.css, drawing.css, page.css and page.js, built into the program.
namespace rosflight::report {

std::string_view colours_css();  ///< Colours by name, for light, dark and print.
std::string_view drawing_css();  ///< What drawings need, in the page and alone.
std::string_view page_css();
std::string_view page_js();

}  // namespace rosflight::report
