#pragma once

#include "tests/support/solids.h"

/// Hand-built solids with surfaces of extrusion and revolution.
namespace lamella::test {

/// Elliptic cylinder about z from z = 0 to `height`, its side a surface of extrusion.
KnownSolid add_extruded_ellipse(Scene& scene, double half_x, double half_y, double height,
                                const SolidOptions& options = {});

/// Ring about z whose section is an ellipse with half axes `wide` (radially) and `high`: one surface of revolution.
KnownSolid add_revolved_ring(Scene& scene, double major, double wide, double high, const SolidOptions& options = {});

/// Ellipsoid about the origin with half axes (radius, radius, half_height): one surface of revolution with two poles.
KnownSolid add_revolved_ellipsoid(Scene& scene, double radius, double half_height, const SolidOptions& options = {});

/// What the line from `from` up to `to` sweeps about z, between two discs: a cylinder, a frustum or, where the line is
/// skew to the axis, a hyperboloid of one sheet.
KnownSolid add_revolved_line(Scene& scene, const Vec3& from, const Vec3& to, const SolidOptions& options = {});

}  // namespace lamella::test
