#include "tests/support/disturb_scene.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "model/evaluate.h"
#include "tests/support/transform_scene.h"

namespace lamella::test {

namespace {

class Disturbance {
 public:
  Disturbance(double gap, unsigned seed) : gap_(gap), random_(seed) {}

  /// Evenly distributed in a ball of radius `gap`.
  template <int Dim>
  Vec<Dim> step() {
    for (;;) {
      Vec<Dim> way;
      for (int i = 0; i < Dim; ++i) way[i] = 2.0 * static_cast<double>(random_()) / 4294967296.0 - 1.0;
      if (way.norm() <= 1.0) return gap_ * way;
    }
  }

  /// A spline's poles each go their own way, other curves go as a whole.
  Curve3 moved(const Curve3& curve) {
    const Vec3 aside = step<3>();
    const bool is_spline = std::holds_alternative<BSplineCurve<3>>(curve);
    return map_curve<3, 3>(
        curve, [&](const Vec3& p) -> Vec3 { return p + (is_spline ? step<3>() : aside); },
        [](const Vec3& d) -> Vec3 { return d; });
  }

  Curve2 moved(const Curve2& pcurve, Interval range, const Face& face) {
    const SurfacePoint at = evaluate(face.surface, evaluate<2>(pcurve, range.middle()).point);
    const Vec2 way = step<2>();
    const Vec2 most = 1e-3 * face.uv_bounds.sizes();
    // Beside a pole a short way on the face is a long one in (u, v).
    const Vec2 aside(std::clamp(way[0] / at.du.norm(), -most[0], most[0]),
                     std::clamp(way[1] / at.dv.norm(), -most[1], most[1]));
    return map_curve<2, 2>(
        pcurve, [&](const Vec2& p) -> Vec2 { return p + aside; }, [](const Vec2& d) -> Vec2 { return d; });
  }

 private:
  double gap_;
  std::mt19937 random_;
};

}  // namespace

Scene disturbed(Scene scene, double gap, unsigned seed, bool stated) {
  for (Solid& solid : scene.solids) solid.info.instance.reset();
  Disturbance disturbance(gap, seed);
  const double tolerance = 3.0 * gap;
  for (Vertex& vertex : scene.vertices) {
    vertex.point += disturbance.step<3>();
    if (stated) vertex.tolerance = std::max(vertex.tolerance, tolerance);
  }
  for (Edge& edge : scene.edges) {
    if (!edge.degenerate) edge.curve = disturbance.moved(edge.curve);
    if (stated) edge.tolerance = std::max(edge.tolerance, tolerance);
  }
  for (HalfEdge& use : scene.half_edges) {
    use.pcurve = disturbance.moved(use.pcurve, use.prange, scene.faces[scene.loops[use.loop].face]);
  }
  for (Face& face : scene.faces) {
    if (stated) face.tolerance = std::max(face.tolerance, tolerance);
  }
  for (Solid& solid : scene.solids) {
    if (stated) solid.info.max_tolerance = std::max(solid.info.max_tolerance, tolerance);
  }
  return scene;
}

}  // namespace lamella::test
