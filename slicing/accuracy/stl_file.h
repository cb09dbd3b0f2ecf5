#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/geometry.h"
#include "model/triangle_mesh.h"

/// Binary STL as other programs write and slice it: coordinates are single precision, so they are rounded on the way.
namespace lamella::accuracy {

/// Three corners, x, y, z each, mm.
using StlTriangle = std::array<float, 9>;

/// The file's size in bytes: a head of 84 and 50 a triangle.
[[nodiscard]] constexpr std::uint64_t stl_bytes(std::uint64_t triangles) { return 84 + 50 * triangles; }

/// Writes a mesh: 80 bytes of title, the number of triangles, and for each its unit normal, corners and a zero, little
/// endian. Throws ExportError.
void write_stl(const TriangleMesh& mesh, const std::filesystem::path& path);

/// Reads the corners back; normals are left alone, as slicers do. Throws InputError on a file of another size than its
/// head says.
[[nodiscard]] std::vector<StlTriangle> read_stl(const std::filesystem::path& path);

/// The volume that the triangles enclose, mm^3: the sum of tetrahedra, in double precision.
[[nodiscard]] double enclosed_volume(const std::vector<StlTriangle>& triangles);

}  // namespace lamella::accuracy
