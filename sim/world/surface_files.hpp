// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>

#include "sim/world/triangles.hpp"

namespace rosflight::sim::world {

/// Axes of both: x east, y north, z up. Each throws config::Error, FILE:LINE: found X, allowed Y.

/// A mesh in Wavefront's .obj: its vertices `v` and faces `f`, which are cut into triangles from their
/// first corner; every other line is skipped. @param scale  by which each axis is multiplied.
TriangleSurface read_obj(const std::filesystem::path& file, const Vector3& scale);

/// Terrain from heights on a square grid in the text form of ESRI (.asc: ncols, nrows, xllcorner or
/// xllcenter, yllcorner or yllcenter, cellsize, NODATA_value; then rows from north to south), which
/// GDAL writes (`gdal_translate -of AAIGrid`). The grid's centre is the origin, heights are as in the
/// file [m]. Each square of four heights is two triangles, parted from south-west to north-east; squares with a
/// missing height are left out.
TriangleSurface read_height_map(const std::filesystem::path& file);

}  // namespace rosflight::sim::world
