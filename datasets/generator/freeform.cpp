#include "datasets/generator/freeform.h"

#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepLib.hxx>
#include <cmath>

#include "datasets/generator/shapes.h"

namespace lamella::datasets {

SplineCurve boundary(const SplineSurface& s, Side side) {
  const int nv = s.count_v, nu = static_cast<int>(s.poles.size()) / nv;
  const bool along_v = side == Side::u_first || side == Side::u_last;
  SplineCurve curve{along_v ? s.degree_v : s.degree_u, along_v ? s.knots_v : s.knots_u, {}, {}};
  for (int k = 0; k < (along_v ? nv : nu); ++k) {
    const int i = along_v ? (side == Side::u_first ? 0 : nu - 1) : k;
    const int j = along_v ? k : (side == Side::v_first ? 0 : nv - 1);
    curve.poles.push_back(s.poles[static_cast<std::size_t>(i) * nv + j]);
    if (!s.weights.empty()) curve.weights.push_back(s.weights[static_cast<std::size_t>(i) * nv + j]);
  }
  return curve;
}

SplineSurface ruled(const SplineCurve& from, const SplineCurve& to) {
  SplineSurface s;
  s.degree_u = from.degree;
  s.degree_v = 1;
  s.knots_u = from.knots;
  s.knots_v = {0, 0, 1, 1};
  s.count_v = 2;
  for (std::size_t i = 0; i < from.poles.size(); ++i) {
    s.poles.push_back(from.poles[i]);
    s.poles.push_back(to.poles[i]);
    if (from.weights.empty()) continue;
    s.weights.push_back(from.weights[i]);
    s.weights.push_back(to.weights[i]);
  }
  return s;
}

std::vector<SplineSurface> between(const SplineSurface& low, const SplineSurface& high) {
  std::vector<SplineSurface> surfaces{low, high};
  for (const Side side : {Side::u_first, Side::u_last, Side::v_first, Side::v_last})
    surfaces.push_back(ruled(boundary(low, side), boundary(high, side)));
  return surfaces;
}

SplineCurve closed_circle(double x, double y, double r) {
  const double w = std::sqrt(0.5);
  return {2,
          {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4},
          {{x + r, y, 0},
           {x + r, y + r, 0},
           {x, y + r, 0},
           {x - r, y + r, 0},
           {x - r, y, 0},
           {x - r, y - r, 0},
           {x, y - r, 0},
           {x + r, y - r, 0},
           {x + r, y, 0}},
          {1, w, 1, w, 1, w, 1, w, 1}};
}

TopoDS_Solid as_nurbs(const TopoDS_Shape& solid) {
  TopoDS_Solid result = only_solid(BRepBuilderAPI_NurbsConvert(solid, true).Shape());
  BRepLib::OrientClosedSolid(result);
  return result;
}

}  // namespace lamella::datasets
