#pragma once

#include <utility>
#include <vector>

#include "core/geometry.h"
#include "model/bezier.h"
#include "model/normal_cone.h"

namespace lamella {

/// Bernstein net of a vector field with the direction of S_u x S_v over a Bezier patch (docs/symbols.md, N): of degree
/// (2p - 1, 2q - 1) for a polynomial patch of degree (p, q), (3p - 1, 3q - 1) for a rational one.
/// net[i * (degree_v + 1) + j], i along u. What the net's vectors span holds every normal of the patch.
struct NormalNet {
  int degree_u = 0;
  int degree_v = 0;
  Interval u;
  Interval v;
  std::vector<Vec3> net;
  double rounding = 0.0;  ///< vectors up to this length may be nothing but rounding
};

[[nodiscard]] NormalNet normal_net(const BezierPatch& patch);

/// The part over a smaller rectangle (clamped to the net's own, which may leave a line or a point).
[[nodiscard]] NormalNet restrict_to(const NormalNet& net, Interval u, Interval v);

[[nodiscard]] inline NormalCone cone_of(const NormalNet& net) { return cone_of(net.net, net.rounding); }

/// Bernstein nets of N_z^2 and |N|^2 over a part of a patch, of twice the degree of N. Their ratio is the square of the
/// slant |n_z|: it doesn't feel normals that turn about the vertical.
struct SlantNet {
  int degree_u = 0;
  int degree_v = 0;
  Interval u;
  Interval v;
  std::vector<double> rising;   ///< N_z^2, as NormalNet::net
  std::vector<double> squared;  ///< |N|^2
  double rounding = 0.0;        ///< coefficients up to this may be nothing but rounding
};

[[nodiscard]] SlantNet slant_net(const NormalNet& normals);

/// The two halves in the middle of u (or v).
[[nodiscard]] std::pair<SlantNet, SlantNet> halves(const SlantNet& net, bool along_u);

/// Bound of the slant over the net, and what it is at those of its corners where there is a normal.
struct SlantRange {
  double bound = 1.0;
  double least_corner = 1.0;
  double most_corner = 0.0;
};
[[nodiscard]] SlantRange slant_range(const SlantNet& net);

/// Does the slant change more along u than along v?
[[nodiscard]] bool changes_more_in_u(const SlantNet& net);

}  // namespace lamella
