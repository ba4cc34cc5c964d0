// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_page.hpp"

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/atomic_file.hpp"
#include "base/base64.hpp"
#include "flight/project_root.hpp"
#include "log/gzip.hpp"

namespace rosflight::flight {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw base::FileError(file.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// An element that holds a text. In JSON "</" would end it, and means the same as "<\/".
std::string element(std::string_view id, std::string_view type, std::string_view text) {
  std::string html = "<script type=\"" + std::string(type) + "\" id=\"" + std::string(id) + "\">";
  for (const char c : text) {
    if (c == '/' && html.back() == '<') html += '\\';
    html += c;
  }
  return html + "</script>\n";
}

}  // namespace

fs::path FlightPage::built() {
  const fs::path root = project_root();
  for (fs::path page : {root / "build/web/report_page.html", root / "page/report_page.html"}) {
    if (fs::exists(page)) return page;
  }
  return {};
}

FlightPage::FlightPage(fs::path page, fs::path folder, const log::TextMap& facts)
    : page_{std::move(page)},
      folder_{std::move(folder)},
      data_{folder_ / "report.mcap"},
      extract_{std::make_unique<log::LogExtract>(data_, facts)} {}

FlightPage::~FlightPage() {
  extract_.reset();
  std::error_code ignored;
  fs::remove(data_, ignored);
  fs::remove(data_.string() + ".part", ignored);
}

void FlightPage::write(std::string_view summary, std::string_view analysis) {
  extract_->close();
  std::string html = contents(page_);
  constexpr std::string_view kMarker = "<!-- flight -->";
  const std::size_t place = html.find(kMarker);
  if (place == std::string::npos) {
    throw std::runtime_error(page_.string() + ": has no line " + std::string(kMarker));
  }
  html.replace(place, kMarker.size(),
               element("flight-summary", "application/json", summary) +
                   element("flight-analysis", "application/json", analysis) +
                   element("flight-log", "application/gzip",
                           base::base64(log::gzip(log::as_bytes(log::LogExtract::without_indexes(
                               log::as_bytes(contents(data_))))))));
  base::write_file(folder_ / "report.html", html);
}

}  // namespace rosflight::flight
