#include "model/move_scene.h"

#include <algorithm>
#include <type_traits>

namespace lamella {

namespace {

/// Moves geometry in place.
class Mover {
 public:
  explicit Mover(const Motion& motion) : motion_(motion) {}

  void move(Curve3& curve) const {
    std::visit([&](auto& c) { move_curve(c); }, curve);
  }
  void move(Surface& surface) const {
    std::visit([&](auto& s) { move_surface(s); }, surface);
  }
  void point(Vec3& p) const { p = motion_.apply(p); }
  void vector(Vec3& d) const { d = motion_.turn * d; }

 private:
  void move_curve(Line<3>& line) const {
    point(line.origin);
    vector(line.direction);
  }
  void move_curve(Ellipse<3>& ellipse) const {
    point(ellipse.center);
    vector(ellipse.major);
    vector(ellipse.minor);
  }
  void move_curve(Parabola<3>& parabola) const {
    point(parabola.apex);
    vector(parabola.axis);
    vector(parabola.tangent);
  }
  void move_curve(Hyperbola<3>& hyperbola) const {
    point(hyperbola.center);
    vector(hyperbola.major);
    vector(hyperbola.minor);
  }
  void move_curve(BSplineCurve<3>& curve) const {
    for (Vec3& pole : curve.poles) point(pole);
  }

  void move_frame(Frame& frame) const {
    point(frame.origin);
    vector(frame.x);
    vector(frame.y);
    vector(frame.z);
  }
  template <class S>
  void move_surface(S& surface) const {
    move_frame(surface.frame);
  }
  void move_surface(Extrusion& surface) const {
    move(surface.basis);
    vector(surface.direction);
  }
  void move_surface(Revolution& surface) const {
    move(surface.meridian);
    point(surface.axis_origin);
    vector(surface.axis_direction);
  }
  void move_surface(BSplineSurface& surface) const {
    for (Vec3& pole : surface.poles) point(pole);
  }
  void move_surface(FittedSurface& surface) const { move_surface(surface.fit); }

  const Motion& motion_;
};

/// An instance of its own for every solid of which the reader knows none, so that no frame is lost.
void complete_instances(Scene& scene) {
  std::size_t next = 0;
  for (const Solid& solid : scene.solids) {
    if (solid.info.instance) next = std::max(next, solid.info.instance->body + 1);
  }
  for (Solid& solid : scene.solids) {
    if (!solid.info.instance) solid.info.instance.emplace().body = next++;
  }
}

}  // namespace

Scene moved(Scene scene, const Motion& motion) {
  const Mover mover(motion);
  complete_instances(scene);
  for (Solid& solid : scene.solids) {
    Instance& instance = *solid.info.instance;
    instance.turn = motion.turn * instance.turn;
    mover.point(instance.shift);
  }
  for (Vertex& vertex : scene.vertices) mover.point(vertex.point);
  for (Edge& edge : scene.edges) mover.move(edge.curve);
  for (Face& face : scene.faces) mover.move(face.surface);
  return scene;
}

bool is_rotation(const Mat3& turn) {
  // Rotations from decimal text are orthogonal to its digits.
  constexpr double kOrthogonal = 1e-9;
  return turn.allFinite() && (turn * turn.transpose() - Mat3::Identity()).norm() < kOrthogonal &&
         turn.determinant() > 0.0;
}

}  // namespace lamella
