// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rosflight::flight::gazebo {

/// What is vertically below or above a point, in axes with z up. Answers what the contacts of an engine do not: whether
/// there is ground at all, and how far down. Bodies are where they were when they were added.
class GroundBelow {
 public:
  struct Surface {
    std::string model;
    double distance_m{};  ///< From the point; 0 inside a box.
  };

  /// @param half  half of each edge. A round shape is given as the box around it, so its ground is as high or higher.
  void add_box(const std::string& model, const Eigen::Isometry3d& pose,
               const Eigen::Vector3d& half);
  void add_triangle(const std::string& model, const std::array<Eigen::Vector3d, 3>& corners);

  std::optional<Surface> below(const Eigen::Vector3d& point) const { return nearest(point, -1.0); }
  std::optional<Surface> above(const Eigen::Vector3d& point) const { return nearest(point, 1.0); }

 private:
  struct Box {
    std::size_t model;
    Eigen::Isometry3d pose;
    Eigen::Vector3d half;
  };
  struct Triangle {
    std::size_t model;
    std::array<Eigen::Vector3d, 3> corners;
  };

  std::size_t number_of(const std::string& model);
  std::optional<Surface> nearest(const Eigen::Vector3d& point, double up) const;

  std::vector<std::string> models_;
  std::vector<Box> boxes_;
  std::vector<Triangle> triangles_;
};

}  // namespace rosflight::flight::gazebo
