#pragma once

#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "slicing/accuracy/crossings.h"
#include "slicing/accuracy/stl_file.h"

namespace lamella::accuracy {

/// What a mesh gave on a lattice of rays.
struct MeshCast {
  Crossings crossings;              ///< ends of the spans where the winding number isn't zero
  std::uint64_t unclosed_rays = 0;  ///< whose crossings don't cancel: the mesh has holes there
};

/// Casts the rays of a lattice at the triangles of one solid, in double precision.
///
/// Every triangle is cut by the planes of the layers. An edge is cut where one end lies at or below the plane and the
/// other above it, and its point is computed from the lower end, whichever triangle asks: so both triangles of an edge
/// get the same point bit for bit. A triangle is cut in none of its edges or in two, one going up and one down, and
/// takes the rows from the lower of the two points on, the point itself included, to the upper one, itself left out. So
/// on every row the crossings of a closed mesh cancel in integers, whatever the rounding, also on edges and vertices
/// that lie on a ray. x is interpolated between the two points. Where edges don't agree in their corners' coordinates
/// the mesh isn't closed, and rays that run through the slit are counted.
[[nodiscard]] MeshCast cast_at_mesh(const std::vector<StlTriangle>& triangles, const RayLattice& lattice,
                                    const Progress& progress, int threads);

/// Areas of the sections of the mesh at the layers' heights, mm^2, by the same cuts: exact for the mesh to rounding.
[[nodiscard]] std::vector<double> mesh_section_areas(const std::vector<StlTriangle>& triangles,
                                                     const std::vector<double>& heights, const Progress& progress,
                                                     int threads);

}  // namespace lamella::accuracy
