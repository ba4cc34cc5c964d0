// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report/curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "flight/report/html.hpp"

namespace rosflight::report {
namespace {

bool is_gap(const Point& p) {
  return !std::isfinite(p.x) || !std::isfinite(p.y);
}

void append_point(std::string& out, char command, const Point& p) {
  out += command;
  append_coordinate(out, p.x);
  out += ' ';
  append_coordinate(out, p.y);
}

/// Writes runs of points; of a horizontal line only the ends.
class Pen {
 public:
  explicit Pen(std::string& out) : out_(out) {}

  void to(const Point& p) {
    if (count_ == 0) {
      append_point(out_, 'M', p);
    } else if (count_ == 1 || !flat(p)) {
      put_waiting();
    }
    if (count_ > 0) before_ = waiting_;
    waiting_ = p;
    ++count_;
  }

  /// Lifts the pen: a gap or the end.
  void end() {
    if (count_ == 1) out_ += "h0";  // A dot.
    if (count_ > 1) append_point(out_, 'L', waiting_);
    count_ = 0;
  }

 private:
  bool flat(const Point& p) const {
    constexpr double kSame = 0.005;  // Half the resolution of the output.
    return std::abs(p.y - waiting_.y) < kSame && std::abs(before_.y - waiting_.y) < kSame;
  }
  void put_waiting() {
    if (count_ > 1) append_point(out_, 'L', waiting_);
  }

  std::string& out_;
  Point before_;
  Point waiting_;
  std::size_t count_{0};
};

/// Marks in `keep` the points of (first, last) that stand off the chord by more than the tolerance,
/// in turn.
void keep_corners(std::span<const Point> points, double tolerance, std::vector<bool>& keep) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    const double dx = points[last].x - points[first].x;
    const double dy = points[last].y - points[first].y;
    const double length = std::hypot(dx, dy);
    double farthest = tolerance;
    std::size_t corner = first;
    for (std::size_t k = first + 1; k < last; ++k) {
      const double px = points[k].x - points[first].x;
      const double py = points[k].y - points[first].y;
      const double distance =
          length > 0.0 ? std::abs(px * dy - py * dx) / length : std::hypot(px, py);
      if (distance > farthest) {
        farthest = distance;
        corner = k;
      }
    }
    if (corner == first) continue;
    keep[corner] = true;
    open.emplace_back(first, corner);
    open.emplace_back(corner, last);
  }
}

void append_run(std::string& out, std::span<const Point> run, double tolerance) {
  // Points a fraction of a pixel apart say nothing and would cost Douglas and Peucker their time.
  std::vector<Point> spread;
  for (const Point& p : run) {
    if (spread.empty() || std::hypot(p.x - spread.back().x, p.y - spread.back().y) > tolerance) {
      spread.push_back(p);
    }
  }
  std::vector<bool> keep(spread.size(), false);
  keep.front() = keep.back() = true;
  keep_corners(spread, tolerance, keep);
  append_point(out, 'M', spread.front());
  if (spread.size() == 1) out += "h0";
  for (std::size_t k = 1; k < spread.size(); ++k) {
    if (keep[k]) append_point(out, 'L', spread[k]);
  }
}

}  // namespace

void append_time_curve(std::string& path_data, std::span<const Point> points) {
  Pen pen(path_data);
  for (std::size_t k = 0; k < points.size();) {
    if (is_gap(points[k])) {
      pen.end();
      ++k;
      continue;
    }
    const double column = std::floor(points[k].x);
    std::size_t low = k;
    std::size_t high = k;
    for (; k < points.size() && !is_gap(points[k]) && std::floor(points[k].x) == column; ++k) {
      if (points[k].y < points[low].y) low = k;
      if (points[k].y > points[high].y) high = k;
    }
    pen.to(points[std::min(low, high)]);
    if (low != high) pen.to(points[std::max(low, high)]);
  }
  pen.end();
}

void append_time_band(std::string& path_data, std::span<const Point> lower,
                      std::span<const Point> upper) {
  const std::size_t count = std::min(lower.size(), upper.size());
  std::vector<Point> below;  // One run between gaps.
  std::vector<Point> above;
  const auto flush = [&] {
    for (std::size_t k = 0; k < below.size(); ++k)
      append_point(path_data, k == 0 ? 'M' : 'L', below[k]);
    for (std::size_t k = above.size(); k-- > 0;) append_point(path_data, 'L', above[k]);
    if (!below.empty()) path_data += 'Z';
    below.clear();
    above.clear();
  };
  for (std::size_t k = 0; k < count;) {
    if (is_gap(lower[k]) || is_gap(upper[k])) {
      flush();
      ++k;
      continue;
    }
    const double column = std::floor(lower[k].x);
    Point low = lower[k];
    Point high = upper[k];
    for (; k < count && !is_gap(lower[k]) && !is_gap(upper[k]) && std::floor(lower[k].x) == column;
         ++k) {
      low.y = std::max(low.y, lower[k].y);  // y runs downwards
      high.y = std::min(high.y, upper[k].y);
    }
    below.push_back(low);
    above.push_back(high);
  }
  flush();
}

void append_track(std::string& path_data, std::span<const Point> points, double tolerance) {
  for (std::size_t k = 0; k < points.size();) {
    const std::size_t first = k;
    while (k < points.size() && !is_gap(points[k])) ++k;
    if (k > first) append_run(path_data, points.subspan(first, k - first), tolerance);
    if (k == first) ++k;
  }
}

}  // namespace rosflight::report
