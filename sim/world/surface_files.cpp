// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/surface_files.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "config/strict_yaml.hpp"

namespace rosflight::sim::world {
namespace {

constexpr std::size_t kMaxPoints = 4'000'000;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// The lines of a text file with their numbers, for messages.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : name_{file.string()}, stream_{file} {
    if (!stream_ || std::filesystem::is_directory(file))
      throw config::Error(name_ + ": found no such file");
  }
  /// The words of the next line. @returns false at the end.
  bool next(std::vector<std::string>& words) {
    std::string line;
    if (!std::getline(stream_, line)) return false;
    ++number_;
    words.clear();
    std::istringstream in(line);
    for (std::string word; in >> word;) words.push_back(word);
    return true;
  }
  [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
    constexpr std::size_t kMaxShown = 40;
    throw config::Error(name_ + ":" + std::to_string(number_) + ": found " +
                        found.substr(0, kMaxShown) + ", allowed " + allowed);
  }
  double number(const std::string& word) const {
    const std::optional<double> value = config::parse_number(word);
    if (!value) fail(word, "a number");
    return *value;
  }

 private:
  std::string name_;
  std::ifstream stream_;
  int number_{0};
};

/// "7", "7/1", "7//3" or, from the end, "-1": the index of a point.
std::uint32_t corner(const Lines& lines, const std::string& word, std::size_t points) {
  const double index = lines.number(word.substr(0, word.find('/')));
  const auto count = static_cast<double>(points);
  const double from_zero = index < 0.0 ? count + index : index - 1.0;
  if (!(from_zero >= 0.0 && from_zero < count) || from_zero != std::floor(from_zero))
    lines.fail("corner " + word, "a vertex above this line");
  return static_cast<std::uint32_t>(from_zero);
}

struct Grid {
  std::size_t columns{}, rows{};
  double cell_m{};
  double missing{kMissing};
};

/// The head of an .asc file; `words` is then its first row of heights.
Grid read_head(Lines& lines, std::vector<std::string>& words) {
  constexpr double kMaxSide = 4000.0;
  Grid grid;
  const auto count = [&](const std::string& word) {
    const double value = lines.number(word);
    if (!(value >= 2.0 && value <= kMaxSide) || value != std::floor(value))
      lines.fail(word, "a whole number from 2 to 4000");
    return static_cast<std::size_t>(value);
  };
  while (lines.next(words)) {
    if (words.empty()) continue;
    if (config::parse_number(words[0])) break;
    const std::string key = words[0];
    if (words.size() != 2) lines.fail(key, "a key and a number");
    if (key == "ncols") {
      grid.columns = count(words[1]);
    } else if (key == "nrows") {
      grid.rows = count(words[1]);
    } else if (key == "cellsize") {
      grid.cell_m = lines.number(words[1]);
      if (!(grid.cell_m > 0.0)) lines.fail("cellsize " + words[1], "a number > 0");
    } else if (key == "NODATA_value" || key == "nodata_value") {
      grid.missing = lines.number(words[1]);
    } else if (key == "xllcorner" || key == "yllcorner" || key == "xllcenter" ||
               key == "yllcenter") {
      static_cast<void>(
          lines.number(words[1]));  // the place on a map: the model's pose says it here
    } else {
      lines.fail(key, "ncols, nrows, cellsize, xllcorner, yllcorner or NODATA_value");
    }
  }
  if (grid.columns == 0 || grid.rows == 0 || grid.cell_m == 0.0)
    lines.fail("heights without ncols, nrows or cellsize", "these three above them");
  return grid;
}

}  // namespace

TriangleSurface read_obj(const std::filesystem::path& file, const Vector3& scale) {
  Lines lines(file);
  std::vector<Vector3> points;
  std::vector<TriangleSurface::Triangle> triangles;
  std::vector<std::string> words;
  while (lines.next(words)) {
    if (words.empty()) continue;
    if (words[0] == "v") {
      if (words.size() < 4) lines.fail("a vertex of less than three numbers", "v X Y Z");
      if (points.size() == kMaxPoints) lines.fail("more vertices", "4000000");
      const Vector3 point(lines.number(words[1]), lines.number(words[2]), lines.number(words[3]));
      points.push_back(point.cwiseProduct(scale));
    } else if (words[0] == "f") {
      if (words.size() < 4) lines.fail("a face of less than three corners", "f A B C");
      const std::uint32_t first = corner(lines, words[1], points.size());
      std::uint32_t last = corner(lines, words[2], points.size());
      for (std::size_t k = 3; k < words.size(); ++k) {
        const std::uint32_t next = corner(lines, words[k], points.size());
        triangles.push_back({first, last, next});
        last = next;
      }
    }
  }
  if (triangles.empty()) lines.fail("no face", "a mesh with faces");
  return {std::move(points), std::move(triangles)};
}

TriangleSurface read_height_map(const std::filesystem::path& file) {
  Lines lines(file);
  std::vector<std::string> words;
  const Grid grid = read_head(lines, words);
  std::vector<Vector3> points;
  points.reserve(grid.columns * grid.rows);
  const double half_x_m = 0.5 * grid.cell_m * static_cast<double>(grid.columns - 1);
  const double half_y_m = 0.5 * grid.cell_m * static_cast<double>(grid.rows - 1);
  bool more = !words.empty();
  for (std::size_t row = 0; row < grid.rows;) {
    if (!more) lines.fail(std::to_string(row) + " rows", std::to_string(grid.rows));
    if (!words.empty()) {
      if (words.size() != grid.columns)
        lines.fail(std::to_string(words.size()) + " heights in a row",
                   std::to_string(grid.columns));
      for (std::size_t column = 0; column < grid.columns; ++column) {
        const double height = lines.number(words[column]);
        points.emplace_back(static_cast<double>(column) * grid.cell_m - half_x_m,
                            half_y_m - static_cast<double>(row) * grid.cell_m,
                            height == grid.missing ? kMissing : height);
      }
      ++row;
    }
    more = lines.next(words);
  }
  if (more && !words.empty()) lines.fail("more rows", std::to_string(grid.rows));
  std::vector<TriangleSurface::Triangle> triangles;
  const auto whole = [&points](const TriangleSurface::Triangle& t) {
    return !std::isnan(points[t[0]].z() + points[t[1]].z() + points[t[2]].z());
  };
  for (std::size_t row = 0; row + 1 < grid.rows; ++row) {
    for (std::size_t column = 0; column + 1 < grid.columns; ++column) {
      const auto north_west = static_cast<std::uint32_t>(row * grid.columns + column);
      const auto south_west = static_cast<std::uint32_t>(north_west + grid.columns);
      const TriangleSurface::Triangle above{south_west, north_west + 1, north_west};
      const TriangleSurface::Triangle below{south_west, south_west + 1, north_west + 1};
      if (!whole(above) || !whole(below)) continue;
      triangles.push_back(above);
      triangles.push_back(below);
    }
  }
  if (triangles.empty()) lines.fail("no square with four heights", "some");
  for (Vector3& point : points) {
    if (std::isnan(point.z())) point.z() = 0.0;  // belongs to no triangle
  }
  return {std::move(points), std::move(triangles)};
}

}  // namespace rosflight::sim::world
