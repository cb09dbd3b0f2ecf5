#pragma once

#include <vector>

#include "slicing/reference/ray_planes.h"
#include "slicing/reference/sub_patch.h"

namespace lamella::reference {

/// The paper's eq. (7) on one sub-patch without its division: F_k(u, v) = n_k . (P - W o), k = 1, 2, where S = P / W is
/// the rational patch. Both are polynomials in Bernstein form on the unit square of the sub-patch; they vanish together
/// exactly where the ray meets the patch, and F_k / W is the distance from plane k in mm.
struct PlaneNets {
  int count_u = 0;         ///< degree_u + 1
  int count_v = 0;         ///< degree_v + 1
  std::vector<double> f1;  ///< f1[i * count_v + j], i along u
  std::vector<double> f2;
  double error = 0.0;                  ///< bound on the rounding error of every coefficient
  const BezierPatch* patch = nullptr;  ///< where they came from; lives longer than the nets are used
};

/// Value and first derivatives of F1, F2 in the unit square's parameters.
struct PlaneValues {
  double f1, f2;
  double f1_u, f1_v;
  double f2_u, f2_v;

  /// det d(F1, F2) / d(u, v). Since n1 x n2 = -d it has the sign of -N.d, N = S_u x S_v: positive where a ray enters
  /// through a face whose outward normal is N (paper, step 5).
  [[nodiscard]] double determinant() const { return f1_u * f2_v - f1_v * f2_u; }
};

/// Fills `nets`, reusing its memory.
void project(const SubPatch& sub_patch, const RayPlanes& planes, PlaneNets& nets);

/// At (u, v), which may lie slightly outside the unit square.
[[nodiscard]] PlaneValues evaluate(const PlaneNets& nets, double u, double v);

/// W at (u, v) of the unit square.
[[nodiscard]] double evaluate_weight(const PlaneNets& nets, double u, double v);

/// Bernstein polynomials of degree count - 1 at t and their derivatives; both arrays hold `count` values.
void bernstein(int count, double t, double* values, double* derivatives);

/// A zero of eq. (7), or a place where the solver could not decide.
struct PatchRoot {
  double u = 0.0;  ///< unit square of the sub-patch
  double v = 0.0;
  double half_u = 0.0;  ///< half-widths of the box that stayed undecided, 0 for a decided root
  double half_v = 0.0;
  bool undecided = false;  ///< tangency: neither existence nor absence of crossings proved
  bool enters = false;     ///< sign of determinant(): the ray runs against N = S_u x S_v
};

}  // namespace lamella::reference
