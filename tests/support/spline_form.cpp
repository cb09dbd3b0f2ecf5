#include "tests/support/spline_form.h"

#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include "model/evaluate.h"
#include "model/rational_form.h"

namespace lamella::test {

namespace {

/// Ends of the patches along one parameter.
std::vector<double> breaks_of(const std::vector<BezierPatch>& patches, Interval BezierPatch::*side) {
  std::set<double> breaks;
  for (const BezierPatch& patch : patches) {
    breaks.insert((patch.*side).lo);
    breaks.insert((patch.*side).hi);
  }
  return {breaks.begin(), breaks.end()};
}

/// Clamped knots of Bezier pieces that share their ends.
std::vector<double> piece_knots(const std::vector<double>& breaks, int degree) {
  std::vector<double> knots{breaks.front()};
  for (const double at : breaks) knots.insert(knots.end(), degree, at);
  knots.push_back(breaks.back());
  return knots;
}

BSplineSurface joined(const std::vector<BezierPatch>& patches) {
  const std::vector<double> breaks_u = breaks_of(patches, &BezierPatch::u);
  const std::vector<double> breaks_v = breaks_of(patches, &BezierPatch::v);
  BSplineSurface result;
  result.degree_u = patches.front().degree_u;
  result.degree_v = patches.front().degree_v;
  result.knots_u = piece_knots(breaks_u, result.degree_u);
  result.knots_v = piece_knots(breaks_v, result.degree_v);
  const int cells_v = static_cast<int>(breaks_v.size()) - 1;
  result.count_u = (static_cast<int>(breaks_u.size()) - 1) * result.degree_u + 1;
  result.count_v = cells_v * result.degree_v + 1;
  for (int i = 0; i < result.count_u; ++i) {
    for (int j = 0; j < result.count_v; ++j) {
      const int cell_u = std::min(i, result.count_u - 2) / result.degree_u;
      const int cell_v = std::min(j, result.count_v - 2) / result.degree_v;
      const BezierPatch& patch = patches[static_cast<std::size_t>(cell_u * cells_v + cell_v)];
      const int at_u = i - cell_u * result.degree_u;
      const int at_v = j - cell_v * result.degree_v;
      const Vec4& pole = patch.net[static_cast<std::size_t>(at_u * (result.degree_v + 1) + at_v)];
      result.poles.push_back(pole.head<3>() / pole.w());
      result.weights.push_back(pole.w());
    }
  }
  return result;
}

}  // namespace

SplineForm spline_form(const Surface& surface, const Box2& uv_bounds) {
  const auto form = std::make_shared<const RationalForm>(rational_form(surface, uv_bounds));
  return {joined(form->patches), [form](const Vec2& uv) { return form->from_surface(uv); }};
}

Curve2 fitted_pcurve(const std::function<Vec2(double)>& uv, Interval range, int spans) {
  BSplineCurve<2> curve{3, {range.lo}, {uv(range.lo)}, {}};
  for (int i = 0; i < spans; ++i) {
    const auto at = [&](int third) { return uv(range.lo + range.length() * (3 * i + third) / (3 * spans)); };
    const Vec2 a = curve.poles.back();
    const Vec2 b = at(1);
    const Vec2 c = at(2);
    const Vec2 d = at(3);
    // Bezier points of the cubic through a, b, c, d at 0, 1/3, 2/3, 1.
    curve.poles.push_back((-5.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 6.0);
    curve.poles.push_back((2.0 * a - 9.0 * b + 18.0 * c - 5.0 * d) / 6.0);
    curve.poles.push_back(d);
    curve.knots.insert(curve.knots.end(), 3, range.lo + range.length() * i / spans);
  }
  curve.knots.insert(curve.knots.end(), 4, range.hi);
  return curve;
}

Scene as_splines(Scene scene) {
  for (Face& face : scene.faces) {
    const SplineForm form = spline_form(face.surface, face.uv_bounds);
    face.uv_bounds = Box2();
    for (const LoopId loop : face.loops) {
      for (const HalfEdgeId id : scene.loops[loop].half_edges) {
        HalfEdge& use = scene.half_edges[id];
        const auto uv = [&](double t) -> Vec2 { return form.from_surface(evaluate<2>(use.pcurve, t).point); };
        use.pcurve = fitted_pcurve(uv, use.prange);
        for (const Vec2& pole : std::get<BSplineCurve<2>>(use.pcurve).poles) face.uv_bounds.extend(pole);
      }
    }
    face.surface = form.surface;
  }
  return scene;
}

}  // namespace lamella::test
