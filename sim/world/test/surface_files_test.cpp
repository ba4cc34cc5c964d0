// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/surface_files.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "config/strict_yaml.hpp"

namespace rosflight::sim::world {
namespace {

std::filesystem::path written(const std::string& name, const std::string& text) {
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / ("surface_files_" + name);
  std::ofstream(file) << text;
  return file;
}

Ray down(double east_m, double north_m) {
  return {{east_m, north_m, 100.0}, {0.0, 0.0, -1.0}};
}
double up_m(const TriangleSurface& surface, double east_m, double north_m) {
  return 100.0 - surface.distance_m(down(east_m, north_m));
}

template <class Read>
std::string refusal(Read read) {
  try {
    read();
  } catch (const config::Error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(ObjFile, TheHillOfTheGazeboTestsIsFourMetresHigh) {
  const TriangleSurface hill = read_obj("flight/gazebo/test/worlds/hill.obj", {1.0, 1.0, 1.0});
  EXPECT_EQ(hill.triangles().size(), 4U);
  EXPECT_NEAR(up_m(hill, 0.0, 0.0), 4.0, 1e-12);
  EXPECT_NEAR(up_m(hill, 15.0, 3.0), 2.0, 1e-12);  // halfway down a face
  EXPECT_NEAR(up_m(read_obj("flight/gazebo/test/worlds/hill.obj", {1.0, 1.0, 2.5}), 0.0, 0.0), 10.0,
              1e-12);
}

TEST(ObjFile, CutsPolygonsAndCountsFromTheEnd) {
  const auto file = written(
      "square.obj", "v 0 0 1\nv 2 0 1\nv 2 2 1\nv 0 2 1\nvn 0 0 1\nf -4//1 -3//1 -2//1 -1//1\n");
  const TriangleSurface square = read_obj(file, {1.0, 1.0, 1.0});
  EXPECT_EQ(square.triangles().size(), 2U);
  EXPECT_NEAR(up_m(square, 0.1, 1.9), 1.0, 1e-12);
}

TEST(ObjFile, RefusesWithLineFoundAndAllowed) {
  const auto bad = [](const std::string& text) {
    const auto file = written("bad.obj", text);
    return refusal([&] { read_obj(file, {1.0, 1.0, 1.0}); }).substr(file.string().size());
  };
  EXPECT_EQ(bad("v 0 0 0\nf 1 2 3\n"), ":2: found corner 2, allowed a vertex above this line");
  EXPECT_EQ(bad("v 0 zero 0\n"), ":1: found zero, allowed a number");
  EXPECT_EQ(bad("v 0 0 0\n"), ":1: found no face, allowed a mesh with faces");
  EXPECT_EQ(refusal([] { read_obj("/nowhere/x.obj", {1.0, 1.0, 1.0}); }),
            "/nowhere/x.obj: found no such file");
}

constexpr const char* kTerrain =
    "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
    "7 8 9\n1 2 4\n";

TEST(HeightMap, HasItsHeightsAtItsCornersAndPlanesBetween) {
  const TriangleSurface terrain = read_height_map(written("terrain.asc", kTerrain));
  EXPECT_NEAR(up_m(terrain, -10.0, 5.0), 7.0, 1e-9);  // north-west
  EXPECT_NEAR(up_m(terrain, 10.0, -5.0), 4.0, 1e-9);  // south-east
  EXPECT_NEAR(up_m(terrain, 0.0, 0.0), 5.0, 1e-9);    // between 8 and 2
  // The western square is parted from 1 in the south-west to 8 in the north-east.
  EXPECT_NEAR(up_m(terrain, -5.0, 0.0), 4.5, 1e-9);
  EXPECT_NEAR(up_m(terrain, -7.5, 2.5), 0.25 * 1.0 + 0.25 * 8.0 + 0.5 * 7.0, 1e-9);
  EXPECT_NEAR(up_m(terrain, -2.5, -2.5), 0.25 * 1.0 + 0.25 * 8.0 + 0.5 * 2.0, 1e-9);
  EXPECT_TRUE(std::isinf(terrain.distance_m(down(10.1, 0.0))));
}

TEST(HeightMap, LeavesOutWhatIsMissing) {
  const auto file =
      written("hole.asc", "ncols 3\nnrows 2\ncellsize 10\nNODATA_value -9999\n7 8 9\n1 2 -9999\n");
  const TriangleSurface terrain = read_height_map(file);
  EXPECT_EQ(terrain.triangles().size(), 2U);
  EXPECT_TRUE(std::isinf(terrain.distance_m(down(5.0, 0.0))));
}

TEST(HeightMap, RefusesWithLineFoundAndAllowed) {
  const auto bad = [](const std::string& text) {
    const auto file = written("bad.asc", text);
    return refusal([&] { read_height_map(file); }).substr(file.string().size());
  };
  EXPECT_EQ(bad("ncols 1\n"), ":1: found 1, allowed a whole number from 2 to 4000");
  EXPECT_EQ(bad("ncols 3\nnrows 2\ncellsize -1\n"), ":3: found cellsize -1, allowed a number > 0");
  EXPECT_EQ(bad("ncols 3\nnrows 2\ncellsize 10\n1 2\n"), ":4: found 2 heights in a row, allowed 3");
  EXPECT_EQ(bad("ncols 3\nnrows 2\ncellsize 10\n1 2 3\n"), ":4: found 1 rows, allowed 2");
  EXPECT_EQ(bad("1 2 3\n"),
            ":1: found heights without ncols, nrows or cellsize, allowed these three above them");
  EXPECT_EQ(
      bad("ncols 3\ncolour 2\n"),
      ":2: found colour, allowed ncols, nrows, cellsize, xllcorner, yllcorner or NODATA_value");
}

}  // namespace
}  // namespace rosflight::sim::world
