#pragma once

#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <gp_Ax1.hxx>
#include <gp_Trsf.hxx>
#include <vector>

#include "datasets/generator/spline.h"

/// Building blocks on OpenCASCADE; lengths in mm, angles in radians.
namespace lamella::datasets {

[[nodiscard]] Handle(Geom_BSplineCurve) to_geom(const SplineCurve& curve);
[[nodiscard]] Handle(Geom_BSplineSurface) to_geom(const SplineSurface& surface);

[[nodiscard]] gp_Trsf translation(double x, double y, double z);
[[nodiscard]] gp_Trsf rotation(const gp_Ax1& axis, double angle);

/// A copy of the shape with the transform worked into its geometry.
[[nodiscard]] TopoDS_Shape moved(const TopoDS_Shape& shape, const gp_Trsf& transform);

[[nodiscard]] TopoDS_Shape box(double x0, double y0, double z0, double x1, double y1, double z1);
[[nodiscard]] TopoDS_Shape cylinder(const Point& base, const Point& direction, double radius, double height);
[[nodiscard]] TopoDS_Shape sphere(const Point& centre, double radius);
[[nodiscard]] TopoDS_Shape torus(const Point& centre, const Point& axis, double major, double minor);

/// A corner of a profile in the half-plane (axial, radial).
using ProfilePoint = std::array<double, 2>;

/// Solid of revolution of a closed polygon (axial, radial) about `axis` (x or z through the origin).
[[nodiscard]] TopoDS_Shape revolved_polygon(const std::vector<ProfilePoint>& corners, char axis = 'x');

/// Volume of the same by Pappus: 2 pi times the polygon's first moment.
[[nodiscard]] double revolved_polygon_volume(const std::vector<ProfilePoint>& corners);

/// Solid of revolution about the x axis of a profile graph y(x) between two x, closed by discs (or its poles).
[[nodiscard]] TopoDS_Shape revolved_graph(const SplineCurve& profile, double from, double to);

/// Prism over a polygon in the plane z = z0.
[[nodiscard]] TopoDS_Shape prism(const std::vector<std::array<double, 2>>& corners, double z0, double z1);

/// Area of a polygon by the shoelace formula, positive when counter-clockwise.
[[nodiscard]] double polygon_area(const std::vector<std::array<double, 2>>& corners);

[[nodiscard]] TopoDS_Shape fuse(const std::vector<TopoDS_Shape>& shapes);
[[nodiscard]] TopoDS_Shape cut(const TopoDS_Shape& from, const std::vector<TopoDS_Shape>& tools);
[[nodiscard]] TopoDS_Shape common(const TopoDS_Shape& a, const TopoDS_Shape& b);

/// The only solid in a shape; throws when there is none or more than one.
[[nodiscard]] TopoDS_Solid only_solid(const TopoDS_Shape& shape);

/// `outer` with cavities that are the given solids, each inside and apart from the others.
[[nodiscard]] TopoDS_Solid with_voids(const TopoDS_Shape& outer, const std::vector<TopoDS_Shape>& cavities);

/// Faces sewn to one closed, outward-oriented solid.
[[nodiscard]] TopoDS_Solid sewn(const std::vector<TopoDS_Face>& faces);

/// Planar face inside the outer boundary edges of `side` that lie in the plane x = at, with an optional inner one.
[[nodiscard]] TopoDS_Face natural_face(const Handle(Geom_Surface) & surface);
[[nodiscard]] TopoDS_Face cap(const std::vector<Handle(Geom_Curve)>& outer,
                              const std::vector<Handle(Geom_Curve)>& inner = {});

}  // namespace lamella::datasets
