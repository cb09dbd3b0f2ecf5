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

/// The two halves in the middle of u (or v).
[[nodiscard]] std::pair<NormalNet, NormalNet> halves(const NormalNet& net, bool along_u);

/// The part over a smaller rectangle (clamped to the net's own, which may leave a line or a point).
[[nodiscard]] NormalNet restrict_to(const NormalNet& net, Interval u, Interval v);

[[nodiscard]] inline NormalCone cone_of(const NormalNet& net) { return cone_of(net.net, net.rounding); }

/// Bound of the slant |n_z| over the net, and what it is at those of its corners where the normal is known.
struct SlantRange {
  double bound = 1.0;
  double least_corner = 1.0;
  double most_corner = 0.0;
};
[[nodiscard]] SlantRange slant_range(const NormalNet& net);

/// Do the normals turn more along u than along v?
[[nodiscard]] bool turns_more_in_u(const NormalNet& net);

}  // namespace lamella
