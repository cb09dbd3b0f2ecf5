#pragma once

#include <array>
#include <span>
#include <vector>

#include "model/bezier.h"
#include "model/curve.h"
#include "model/surface.h"

namespace lamella {

/// Throws GeometryError unless the arrays fit together, all numbers are finite, the knots ascend and are clamped
/// (no knot more often than degree + 1), and degree and weights keep to kMaxDegree and kMaxWeightRatio.
void check_limits(const BSplineSurface& surface);
template <int Dim>
void check_limits(const BSplineCurve<Dim>& curve);

extern template void check_limits<2>(const BSplineCurve<2>&);
extern template void check_limits<3>(const BSplineCurve<3>&);

/// Index i of the non-empty knot span [knots[i], knots[i + 1]) that holds `t`, `t` clamped to the domain; the last
/// non-empty span at the domain's end.
[[nodiscard]] int find_span(std::span<const double> knots, int degree, double t);

/// One value per B-spline that doesn't vanish on a span, and room for the highest degree.
using BasisRow = std::array<double, kMaxDegree + 1>;

/// Raises the `degree` B-splines in row[0, degree) of one degree less on `span` by one degree at `x`: the Cox-de Boor
/// recursion (paper eq. 2 with its slips put right, see docs/methods/exact-model.md).
void raise_degree(std::span<const double> knots, int span, int degree, double x, BasisRow& row);

/// The degree + 1 B-splines of `span` at `t` with their first and second derivatives (zero above `order`).
struct Basis {
  int first = 0;  ///< index of the first pole they belong to
  std::array<BasisRow, 3> derivative;
};
[[nodiscard]] Basis evaluate_basis(std::span<const double> knots, int degree, double t, int order);

/// The matrix row of Oslo knot insertion: new pole i = sum over j of alpha[j] * pole[first + j].
struct DiscreteBSpline {
  int first = 0;
  BasisRow alpha;
};

/// The discrete B-splines alpha_{j,k}(i) of Cohen, Lyche and Riesenfeld (1980), order k = degree + 1, for pole `i` over
/// the knots `refined`, which hold every knot of `knots` at least as often. Not negative, and they sum to one.
[[nodiscard]] DiscreteBSpline discrete_bspline(std::span<const double> knots, std::span<const double> refined,
                                               int degree, int i);

/// The knots of `knots` and `new_knots` together, ascending. Throws GeometryError when a new knot lies outside the
/// domain or a knot would come more often than degree + 1 times.
[[nodiscard]] std::vector<double> merge_knots(std::span<const double> knots, int degree,
                                              std::span<const double> new_knots);

/// What must be inserted for every inner knot to have at least multiplicity `degree`.
[[nodiscard]] std::vector<double> bezier_knots(std::span<const double> knots, int degree);

/// Knot insertion by the Oslo algorithm, as refine_u() for surfaces.
template <int Dim>
[[nodiscard]] BSplineCurve<Dim> refine(const BSplineCurve<Dim>& curve, std::span<const double> new_knots);

extern template BSplineCurve<2> refine<2>(const BSplineCurve<2>&, std::span<const double>);
extern template BSplineCurve<3> refine<3>(const BSplineCurve<3>&, std::span<const double>);

}  // namespace lamella
