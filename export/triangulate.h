#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// Corners of a triangle by number, counterclockwise.
using Triangle = std::array<std::uint32_t, 3>;

/// Fills an outer loop with holes by triangles that have no corners but the loops': points are numbered through the
/// loops, the outer one first. Outer loops run counterclockwise, holes clockwise; loops may touch but not cross. Every
/// side of a loop belongs to one triangle, every other side to two, whatever the loops: what is built on them closes.
/// By ear clipping (D. Eberly, Triangulation by Ear Clipping, 2002); work grows with the square of the points.
[[nodiscard]] std::vector<Triangle> triangulate(std::span<const std::span<const Vec2>> loops);

}  // namespace lamella
