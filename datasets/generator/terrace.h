#pragma once

#include <TopoDS_Solid.hxx>
#include <functional>
#include <vector>

#include "datasets/generator/spline.h"

/// Free-form solids made of roofs z = f(x, y) and vertical walls over outlines in the plan, with every edge curve
/// exact: a Bezier height field along a conic is again a rational Bezier curve. So the volumes have formulas.
namespace lamella::datasets {

/// Closed counter-clockwise chain of quadratic Bezier curves (rational or not) in the plane z = 0.
using Plan = std::vector<SplineCurve>;

/// Quadratic Bezier curve; a middle weight other than 1 makes it rational.
[[nodiscard]] SplineCurve conic(const Point& a, const Point& b, const Point& c, double weight = 1.0);

/// Circle as three arcs of 120 degrees.
[[nodiscard]] Plan circle_plan(double x, double y, double radius);

/// Rounded rectangle of four bulged parabolas and four corners that join tangentially; sizes in mm. `corner_weight`
/// is the middle weight of the corners.
struct Squircle {
  double x = 0, y = 0, half_x = 10, half_y = 10, corner = 3, bulge = 1, corner_weight = 0.7;
};
[[nodiscard]] Plan squircle(const Squircle& s);

/// Eye-shaped outline of two parabolas between two corners on a line at `angle`.
[[nodiscard]] Plan eye(double x, double y, double half_length, double half_width, double angle);

/// Bent slot about the origin between two radii and two angles: two arcs and two rounded ends.
[[nodiscard]] Plan kidney(double r0, double r1, double angle0, double angle1);

/// Single Bezier patch z = f(x, y) over a rectangle, parameters (x, y); `f` gives the poles.
struct Rectangle {
  double x0, x1, y0, y1;
};
[[nodiscard]] SplineSurface height_patch(const Rectangle& r, int degree,
                                         const std::function<double(double, double)>& f);

/// The same patch, higher by `offset` mm.
[[nodiscard]] SplineSurface raised(SplineSurface patch, double offset);

/// A solid in terms of its plans and fields, by index.
struct Terrace {
  struct Roof {
    int field;
    bool up;                 ///< the material is below
    int outer;               ///< plan
    std::vector<int> holes;  ///< plans
  };
  struct Wall {
    int plan, low, high;   ///< plan, and the fields it stands between
    bool material_inside;  ///< of the plan's outline
  };
  std::vector<Plan> plans;  ///< each is the foot of exactly one wall
  std::vector<SplineSurface> fields;
  std::vector<Roof> roofs;
  std::vector<Wall> walls;
};

[[nodiscard]] TopoDS_Solid build(const Terrace& terrace);

/// Signed sum of the integrals over the roofs: Green's theorem with Gauss quadrature, mm^3.
[[nodiscard]] double volume(const Terrace& terrace);

/// Integral of the height field over the inside of the outline, mm^3.
[[nodiscard]] double volume_under(const SplineSurface& field, const Plan& plan);

/// The body between two fields over `outer`, with openings.
[[nodiscard]] Terrace slab(const Plan& outer, const SplineSurface& low, const SplineSurface& high,
                           const std::vector<Plan>& openings = {});

}  // namespace lamella::datasets
