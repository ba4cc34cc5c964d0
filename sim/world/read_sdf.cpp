// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/read_sdf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "base/constants.hpp"
#include "config/strict_yaml.hpp"
#include "sim/portable_math.hpp"
#include "sim/world/surface_files.hpp"
#include "sim/world/xml.hpp"

namespace rosflight::sim::world {
namespace {

constexpr std::uintmax_t kMaxWorldBytes = 64U << 20U;
/// Elements of a world that have no surface.
constexpr std::array<std::string_view, 12> kSkipped{"atmosphere",
                                                    "audio",
                                                    "gravity",
                                                    "gui",
                                                    "light",
                                                    "magnetic_field",
                                                    "physics",
                                                    "plugin",
                                                    "road",
                                                    "scene",
                                                    "spherical_coordinates",
                                                    "wind"};

/// A frame in SDF's axes: x east, y north, z up.
struct SdfPose {
  Vector3 p{Vector3::Zero()};
  Matrix3 R{Matrix3::Identity()};
  SdfPose operator*(const SdfPose& inner) const { return {p + R * inner.p, R * inner.R}; }
};

/// SDF's world axes to north, east, down: both change places, without rounding.
const Matrix3 kWorldFromSdf =
    (Matrix3() << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0).finished();

/// R = R_z(yaw) R_y(pitch) R_x(roll).
Matrix3 rotation(double roll, double pitch, double yaw) {
  const auto [sr, cr] = portable::sin_cos(roll);
  const auto [sp, cp] = portable::sin_cos(pitch);
  const auto [sy, cy] = portable::sin_cos(yaw);
  Matrix3 R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

class SdfReader {
 public:
  explicit SdfReader(const std::filesystem::path& file) : file_{file} {}

  WorldShapes read() {
    const XmlElement root = read_xml(text(), file_.string());
    path_ = "sdf";
    if (root.name != "sdf") fail(root, root.name, "sdf");
    const XmlElement* world = nullptr;
    for (const XmlElement& one : root.children) {
      if (one.name != "world") fail(one, one.name, "world");
      if (world != nullptr) fail(one, "a second world", "one");
      world = &one;
    }
    if (world == nullptr) fail(root, "no world", "one");
    for (const XmlElement& one : world->children) {
      path_ = "world";
      if (one.name == "model") {
        model(one, SdfPose{});
      } else if (std::find(kSkipped.begin(), kSkipped.end(), one.name) == kSkipped.end()) {
        fail(one, one.name, "model");
      }
    }
    return std::move(shapes_);
  }

 private:
  [[noreturn]] void fail(const XmlElement& at, const std::string& found,
                         const std::string& allowed) const {
    throw config::Error(file_.string() + ":" + std::to_string(at.line) + ": " + path_ + ": found " +
                        found + ", allowed " + allowed);
  }

  std::string text() const {
    std::error_code code;
    std::ifstream stream(file_, std::ios::binary);
    if (!stream || !std::filesystem::is_regular_file(file_, code))
      throw config::Error(file_.string() + ": found no such file");
    if (std::filesystem::file_size(file_, code) > kMaxWorldBytes)
      throw config::Error(file_.string() + ": found a larger file, allowed 64 MiB");
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  /// Appends to the path of messages: "model house".
  void enter(const XmlElement& element) {
    const auto name = element.attributes.find("name");
    path_ += ", " + element.name + (name == element.attributes.end() ? "" : " " + name->second);
  }

  template <std::size_t kCount>
  std::array<double, kCount> numbers(const XmlElement& element) const {
    std::array<double, kCount> out{};
    std::istringstream stream(element.text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    bool good = words.size() == kCount;
    for (std::size_t k = 0; k < kCount && good; ++k) {
      const std::optional<double> value = config::parse_number(words[k]);
      good = value.has_value();
      out[k] = value.value_or(0.0);
    }
    if (!good)
      fail(element, element.name + " '" + element.text + "'",
           std::to_string(kCount) + (kCount == 1 ? " number" : " numbers"));
    return out;
  }

  const XmlElement& needed(const XmlElement& parent, const char* key) const {
    const XmlElement* found = parent.child(key);
    if (found == nullptr)
      fail(parent, parent.name + " without " + key, std::string("one with ") + key);
    return *found;
  }
  Vector3 vector(const XmlElement& element) const {
    const auto n = numbers<3>(element);
    return {n[0], n[1], n[2]};
  }
  double positive(const XmlElement& parent, const char* key) const {
    const XmlElement& element = needed(parent, key);
    const double value = numbers<1>(element)[0];
    if (!(value > 0.0)) fail(element, element.name + " " + element.text, "a number > 0");
    return value;
  }

  SdfPose pose(const XmlElement& parent) const {
    const XmlElement* element = parent.child("pose");
    if (element == nullptr || element->text.empty()) return {};
    double unit = 1.0;
    for (const auto& [key, value] : element->attributes) {
      if (key == "degrees" && (value == "true" || value == "1")) {
        unit = base::kRadPerDeg;
      } else if (!value.empty() && key != "degrees" &&
                 !(key == "rotation_format" && value == "euler_rpy")) {
        fail(*element, "pose with " + key + " " + value, "x y z roll pitch yaw from the parent");
      }
    }
    const auto n = numbers<6>(*element);
    return {{n[0], n[1], n[2]}, rotation(unit * n[3], unit * n[4], unit * n[5])};
  }

  void model(const XmlElement& element, const SdfPose& outer, bool outer_static = false) {
    const std::string path = path_;
    enter(element);
    const XmlElement* flag = element.child("static");
    const bool is_static =
        flag == nullptr ? outer_static : flag->text == "true" || flag->text == "1";
    if (!is_static) fail(element, "a model that moves", "<static>true</static>");
    const SdfPose here = outer * pose(element);
    for (const XmlElement& one : element.children) {
      if (one.name == "link") {
        link(one, here);
      } else if (one.name == "model") {
        model(one, here, true);
      } else if (one.name == "include") {
        fail(one, one.name, "link or model");
      }
    }
    path_ = path;
  }

  void link(const XmlElement& element, const SdfPose& outer) {
    const std::string path = path_;
    enter(element);
    const SdfPose here = outer * pose(element);
    for (const XmlElement& one : element.children) {
      if (one.name != "collision") continue;
      const std::string inner = path_;
      enter(one);
      const SdfPose place = here * pose(one);
      shape(needed(one, "geometry"), place);
      path_ = inner;
    }
    path_ = path;
  }

  void shape(const XmlElement& geometry, const SdfPose& outer) {
    std::string name = path_.substr(path_.find(',') + 2);
    path_ += ", geometry";
    if (geometry.children.size() != 1)
      fail(geometry, std::to_string(geometry.children.size()) + " shapes", "one");
    const XmlElement& one = geometry.children.front();
    SdfPose place = outer;
    Geometry made;
    if (one.name == "box") {
      const XmlElement& size = needed(one, "size");
      const Vector3 size_m = vector(size);
      if (!(size_m.minCoeff() > 0.0)) fail(size, "size " + size.text, "three numbers > 0");
      made = Box{size_m};
    } else if (one.name == "sphere") {
      made = Sphere{positive(one, "radius")};
    } else if (one.name == "cylinder") {
      made = Cylinder{positive(one, "radius"), positive(one, "length")};
    } else if (one.name == "plane") {
      place.R = place.R * with_z_along(one);
      made = Plane{};
    } else if (one.name == "mesh") {
      made = mesh(one);
    } else if (one.name == "heightmap") {
      if (const XmlElement* at = one.child("pos")) place.p += place.R * vector(*at);
      if (const XmlElement* size = one.child("size"))
        fail(*size, "size of a heightmap", "none: an .asc file has its own");
      made = std::make_shared<TriangleSurface>(read_height_map(path_of(one, ".asc")));
    } else {
      fail(one, one.name, "box, cylinder, heightmap, mesh, plane or sphere");
    }
    shapes_.add(
        {std::move(name), kWorldFromSdf * place.p, kWorldFromSdf * place.R, std::move(made)});
  }

  /// A rotation that takes z to the normal of a plane.
  Matrix3 with_z_along(const XmlElement& plane) const {
    const XmlElement* element = plane.child("normal");
    if (element == nullptr) return Matrix3::Identity();
    const Vector3 wanted = vector(*element);
    if (!(wanted.norm() > 0.0)) fail(*element, "normal " + element->text, "a vector that is not 0");
    const Vector3 z = wanted / wanted.norm();
    const Vector3 other = std::abs(z.x()) < 0.5 ? Vector3::UnitX() : Vector3::UnitY();
    Matrix3 R;
    R.col(2) = z;
    R.col(0) = other - other.dot(z) * z;
    R.col(0) /= R.col(0).norm();
    R.col(1) = z.cross(Vector3(R.col(0)));
    return R;
  }

  Geometry mesh(const XmlElement& element) const {
    if (const XmlElement* part = element.child("submesh")) fail(*part, "submesh", "a whole mesh");
    const XmlElement* scale = element.child("scale");
    const Vector3 by = scale == nullptr ? Vector3(1.0, 1.0, 1.0) : vector(*scale);
    return std::make_shared<TriangleSurface>(read_obj(path_of(element, ".obj"), by));
  }

  /// The file of a `uri` with this extension.
  std::filesystem::path path_of(const XmlElement& parent, const char* extension) const {
    const XmlElement& uri = needed(parent, "uri");
    std::string name = uri.text;
    for (const std::string scheme : {"file://", "model://"})
      if (name.starts_with(scheme)) name = name.substr(scheme.size());
    const std::filesystem::path file = file_.parent_path() / name;
    if (file.extension() != extension)
      fail(uri, "uri " + uri.text, std::string("a file *") + extension);
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
      fail(uri, "uri " + uri.text, "a file that is there, such as in the folder of the world");
    return file;
  }

  std::filesystem::path file_;
  std::string path_;
  WorldShapes shapes_;
};

}  // namespace

WorldShapes read_sdf_world(const std::filesystem::path& file) {
  return SdfReader(file).read();
}

}  // namespace rosflight::sim::world
