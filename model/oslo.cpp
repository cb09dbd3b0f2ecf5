#include <algorithm>
#include <string>

#include "core/error.h"
#include "model/bspline.h"

namespace lamella {
namespace {

/// A pole grid in homogeneous coordinates (w x, ..., w), rows along the refined direction.
template <int Size>
struct Grid {
  int rows = 0;
  int columns = 0;
  std::vector<Vec<Size>> points;
};

template <int Size>
Grid<Size> refine_rows(const Grid<Size>& grid, std::span<const double> knots, std::span<const double> refined,
                       int degree) {
  Grid<Size> result{static_cast<int>(refined.size()) - degree - 1, grid.columns, {}};
  result.points.assign(static_cast<std::size_t>(result.rows) * result.columns, Vec<Size>::Zero());
  for (int i = 0; i < result.rows; ++i) {
    const DiscreteBSpline row = discrete_bspline(knots, refined, degree, i);
    for (int k = 0; k <= degree; ++k) {
      if (row.alpha[k] == 0.0) continue;
      const Vec<Size>* source = &grid.points[static_cast<std::size_t>(row.first + k) * grid.columns];
      Vec<Size>* target = &result.points[static_cast<std::size_t>(i) * grid.columns];
      for (int j = 0; j < grid.columns; ++j) target[j] += row.alpha[k] * source[j];
    }
  }
  return result;
}

template <int Size>
Grid<Size> transpose(const Grid<Size>& grid) {
  Grid<Size> result{grid.columns, grid.rows, std::vector<Vec<Size>>(grid.points.size())};
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.columns; ++j) {
      result.points[static_cast<std::size_t>(j) * grid.rows + i] =
          grid.points[static_cast<std::size_t>(i) * grid.columns + j];
    }
  }
  return result;
}

template <int Dim>
std::vector<Vec<Dim + 1>> to_homogeneous(const std::vector<Vec<Dim>>& poles, const std::vector<double>& weights) {
  std::vector<Vec<Dim + 1>> result(poles.size());
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    result[i] << weight * poles[i], weight;
  }
  return result;
}

/// Writes the points back as poles and, if there were any, weights.
template <int Dim>
void from_homogeneous(const std::vector<Vec<Dim + 1>>& points, std::vector<Vec<Dim>>& poles,
                      std::vector<double>& weights) {
  const bool rational = !weights.empty();
  poles.resize(points.size());
  weights.resize(rational ? points.size() : 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Polynomial poles keep weight 1 but for rounding; dividing by it would only add to the rounding.
    const double weight = rational ? points[i][Dim] : 1.0;
    poles[i] = points[i].template head<Dim>() / weight;
    if (rational) weights[i] = weight;
  }
}

Grid<4> pole_grid(const BSplineSurface& surface) {
  return {surface.count_u, surface.count_v, to_homogeneous<3>(surface.poles, surface.weights)};
}

/// Bounds the memory that a hostile surface of many knots and high degree could ask for.
constexpr double kMaxNetPoints = 1 << 24;

int count_spans(std::span<const double> knots) {
  int count = 0;
  for (std::size_t i = 1; i < knots.size(); ++i) count += knots[i] > knots[i - 1];
  return count;
}

void check_net_size(const BSplineSurface& surface) {
  const double pieces = static_cast<double>(count_spans(surface.knots_u)) * count_spans(surface.knots_v);
  const double points = pieces * (surface.degree_u + 1) * (surface.degree_v + 1);
  if (points <= kMaxNetPoints) return;
  throw GeometryError("a B-spline surface whose Bezier nets would have " + std::to_string(points) +
                      " control points, more than the limit of " + std::to_string(kMaxNetPoints));
}

BezierPatch cut_patch(const Grid<4>& grid, std::span<const double> knots_u, std::span<const double> knots_v,
                      int degree_u, int degree_v, int span_u, int span_v) {
  BezierPatch patch{
      degree_u, degree_v, {knots_u[span_u], knots_u[span_u + 1]}, {knots_v[span_v], knots_v[span_v + 1]}, {}};
  patch.net.reserve(static_cast<std::size_t>(degree_u + 1) * (degree_v + 1));
  for (int i = span_u - degree_u; i <= span_u; ++i) {
    const auto row = grid.points.begin() + static_cast<std::ptrdiff_t>(i) * grid.columns + span_v - degree_v;
    patch.net.insert(patch.net.end(), row, row + degree_v + 1);
  }
  return patch;
}

}  // namespace

DiscreteBSpline discrete_bspline(std::span<const double> knots, std::span<const double> refined, int degree, int i) {
  const auto above = std::upper_bound(knots.begin(), knots.end(), refined[i]);
  const int span = static_cast<int>(above - knots.begin()) - 1;
  DiscreteBSpline result;
  result.first = span - degree;
  result.alpha[0] = 1.0;
  // The recursion of the B-splines themselves, but with a new knot of its own in place of t at each degree. Knots are
  // copied, never computed, so the factors that must vanish do so exactly.
  for (int d = 1; d <= degree; ++d) raise_degree(knots, span, d, refined[i + d], result.alpha);
  return result;
}

std::vector<double> merge_knots(std::span<const double> knots, int degree, std::span<const double> new_knots) {
  std::vector<double> result(knots.size() + new_knots.size());
  if (!std::is_sorted(new_knots.begin(), new_knots.end())) throw GeometryError("new knots that don't ascend");
  std::merge(knots.begin(), knots.end(), new_knots.begin(), new_knots.end(), result.begin());
  const auto order = static_cast<std::size_t>(degree) + 1;
  for (const double knot : new_knots) {
    if (!(knot >= knots.front() && knot <= knots.back())) throw GeometryError("a new knot outside the domain");
  }
  for (std::size_t i = order; i < result.size(); ++i) {
    if (result[i] == result[i - order]) throw GeometryError("a knot inserted more than degree + 1 times");
  }
  return result;
}

std::vector<double> bezier_knots(std::span<const double> knots, int degree) {
  std::vector<double> result;
  for (auto knot = knots.begin(); knot != knots.end();) {
    const auto next = std::upper_bound(knot, knots.end(), *knot);
    const bool inner = *knot > knots.front() && *knot < knots.back();
    for (auto multiplicity = next - knot; inner && multiplicity < degree; ++multiplicity) result.push_back(*knot);
    knot = next;
  }
  return result;
}

BSplineSurface refine_u(const BSplineSurface& surface, std::span<const double> new_knots) {
  check_limits(surface);
  BSplineSurface result = surface;
  result.knots_u = merge_knots(surface.knots_u, surface.degree_u, new_knots);
  const Grid<4> grid = refine_rows(pole_grid(surface), surface.knots_u, result.knots_u, surface.degree_u);
  result.count_u = grid.rows;
  from_homogeneous<3>(grid.points, result.poles, result.weights);
  return result;
}

BSplineSurface refine_v(const BSplineSurface& surface, std::span<const double> new_knots) {
  check_limits(surface);
  BSplineSurface result = surface;
  result.knots_v = merge_knots(surface.knots_v, surface.degree_v, new_knots);
  const Grid<4> grid = refine_rows(transpose(pole_grid(surface)), surface.knots_v, result.knots_v, surface.degree_v);
  result.count_v = grid.rows;
  from_homogeneous<3>(transpose(grid).points, result.poles, result.weights);
  return result;
}

template <int Dim>
BSplineCurve<Dim> refine(const BSplineCurve<Dim>& curve, std::span<const double> new_knots) {
  check_limits(curve);
  BSplineCurve<Dim> result = curve;
  result.knots = merge_knots(curve.knots, curve.degree, new_knots);
  const Grid<Dim + 1> poles{static_cast<int>(curve.poles.size()), 1, to_homogeneous<Dim>(curve.poles, curve.weights)};
  const Grid<Dim + 1> grid = refine_rows(poles, curve.knots, result.knots, curve.degree);
  from_homogeneous<Dim>(grid.points, result.poles, result.weights);
  return result;
}

template BSplineCurve<2> refine<2>(const BSplineCurve<2>&, std::span<const double>);
template BSplineCurve<3> refine<3>(const BSplineCurve<3>&, std::span<const double>);

std::vector<BezierPatch> split_to_bezier(const BSplineSurface& surface) {
  check_limits(surface);
  check_net_size(surface);
  const int p = surface.degree_u;
  const int q = surface.degree_v;
  const auto knots_u = merge_knots(surface.knots_u, p, bezier_knots(surface.knots_u, p));
  const auto knots_v = merge_knots(surface.knots_v, q, bezier_knots(surface.knots_v, q));
  Grid<4> grid = refine_rows(pole_grid(surface), surface.knots_u, knots_u, p);
  grid = transpose(refine_rows(transpose(grid), surface.knots_v, knots_v, q));
  std::vector<BezierPatch> patches;
  for (int i = p; i < grid.rows; ++i) {
    if (knots_u[i] == knots_u[i + 1]) continue;
    for (int j = q; j < grid.columns; ++j) {
      if (knots_v[j] < knots_v[j + 1]) patches.push_back(cut_patch(grid, knots_u, knots_v, p, q, i, j));
    }
  }
  if (surface.weights.empty()) {
    for (BezierPatch& patch : patches) {
      for (Vec4& point : patch.net) point[3] = 1.0;
    }
  }
  return patches;
}

}  // namespace lamella
