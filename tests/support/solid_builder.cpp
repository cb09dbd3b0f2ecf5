#include "tests/support/solid_builder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/support/transform_scene.h"

namespace lamella::test {

namespace {

constexpr double kEdgeTolerance = 1e-7;

void extend(Box2& box, const Curve2& pcurve, Interval range) {
  if (const auto* line = std::get_if<Line<2>>(&pcurve)) {
    box.extend(line->origin + range.lo * line->direction);
    box.extend(line->origin + range.hi * line->direction);
  } else if (const auto* ellipse = std::get_if<Ellipse<2>>(&pcurve)) {
    // Whole circles only, the solids here have no other arcs in (u, v).
    const Vec2 reach = (ellipse->major.array().square() + ellipse->minor.array().square()).sqrt();
    box.extend(ellipse->center - reach);
    box.extend(ellipse->center + reach);
  } else {
    for (const Vec2& pole : std::get<BSplineCurve<2>>(pcurve).poles) box.extend(pole);
  }
}

}  // namespace

std::size_t SolidPlan::vertex(const Vec3& point) {
  vertices.push_back(point);
  return vertices.size() - 1;
}

std::size_t SolidPlan::edge(const Curve3& curve, Interval range, std::size_t start, std::size_t end) {
  edges.push_back({curve, range, start, end});
  return edges.size() - 1;
}

std::size_t SolidPlan::degenerate_edge(Interval range, std::size_t at) {
  edges.push_back({Line<3>{vertices[at], Vec3::Zero()}, range, at, at, true});
  return edges.size() - 1;
}

std::pair<std::size_t, bool> SolidPlan::line(std::size_t from, std::size_t to) {
  if (const auto known = lines_.find({to, from}); known != lines_.end()) return {known->second, false};
  const Vec3 way = vertices[to] - vertices[from];
  const std::size_t made = edge(Line<3>{vertices[from], way.normalized()}, {0.0, way.norm()}, from, to);
  lines_[{from, to}] = made;
  return {made, true};
}

Curve2 project(const Curve3& curve, const Plane& plane) {
  const Frame& f = plane.frame;
  const auto vector = [&](const Vec3& d) -> Vec2 { return {f.x.dot(d), f.y.dot(d)}; };
  return map_curve<2, 3>(
      curve, [&](const Vec3& p) -> Vec2 { return vector(p - f.origin); }, vector);
}

Curve2 line_pcurve(const Vec2& from, const Vec2& to, Interval range) {
  const Vec2 direction = (to - from) / range.length();
  return Line<2>{from - range.lo * direction, direction};
}

FacePlan planar_face(const SolidPlan& plan, const Frame& frame,
                     const std::vector<std::vector<std::pair<std::size_t, bool>>>& loops) {
  const Plane plane{frame};
  FacePlan face{plane, true, {}};
  for (const auto& loop : loops) {
    auto& uses = face.loops.emplace_back();
    for (const auto& [edge, forward] : loop) uses.push_back({edge, forward, project(plan.edges[edge].curve, plane)});
  }
  return face;
}

FacePlan rectangle_face(const Surface& surface, Interval u, Interval v, const SolidPlan& plan, std::size_t bottom,
                        std::size_t right, std::size_t top, std::size_t left) {
  const auto pcurve = [&](std::size_t edge, const Vec2& from, const Vec2& to) {
    return line_pcurve(from, to, plan.edges[edge].range);
  };
  return {surface,
          true,
          {{{bottom, true, pcurve(bottom, {u.lo, v.lo}, {u.hi, v.lo})},
            {right, true, pcurve(right, {u.hi, v.lo}, {u.hi, v.hi})},
            {top, false, pcurve(top, {u.lo, v.hi}, {u.hi, v.hi})},
            {left, false, pcurve(left, {u.lo, v.lo}, {u.lo, v.hi})}}}};
}

namespace {

/// Enters one plan into a scene, keeping the offsets of its edges.
class Entry {
 public:
  Entry(Scene& scene, const SolidPlan& plan, const SolidOptions& options)
      : scene_(scene), plan_(plan), options_(options), first_edge_(scene.edges.size()) {}

  SolidId run() {
    enter_vertices_and_edges();
    const SolidId id{scene_.solids.size()};
    Solid solid;
    solid.shells.first = ShellId{scene_.shells.size()};
    for (const auto& shell : plan_.shells) {
      enter_shell(shell, id, solid.shells.count > 0);
      ++solid.shells.count;
    }
    solid.info.name = options_.name;
    solid.info.path = options_.path.empty() ? "/" + options_.name : options_.path;
    solid.info.color = options_.color;
    solid.info.max_tolerance = kEdgeTolerance;
    scene_.solids.push_back(std::move(solid));
    return id;
  }

 private:
  void enter_vertices_and_edges() {
    const std::size_t first_vertex = scene_.vertices.size();
    for (const Vec3& point : plan_.vertices) {
      scene_.vertices.push_back({options_.placement.apply(point), kEdgeTolerance});
    }
    for (const EdgePlan& plan : plan_.edges) {
      scene_.edges.push_back({placed(plan.curve, options_.placement), plan.range, VertexId{first_vertex + plan.start},
                              VertexId{first_vertex + plan.end}, kEdgeTolerance, plan.degenerate, 0});
    }
  }

  void enter_shell(const std::vector<FacePlan>& faces, SolidId solid, bool is_void) {
    const ShellId id{scene_.shells.size()};
    Shell shell{solid, {FaceId{scene_.faces.size()}, static_cast<std::uint32_t>(faces.size())}, true, is_void, 0};
    scene_.shells.push_back(shell);
    open_uses_.clear();
    for (const FacePlan& face : faces) enter_face(face, id);
    if (!open_uses_.empty()) throw std::logic_error("hand-built shell is not closed");
  }

  void enter_face(const FacePlan& plan, ShellId shell) {
    const FaceId id{scene_.faces.size()};
    Face face;
    face.shell = shell;
    face.surface = placed(plan.surface, options_.placement);
    face.same_sense = plan.same_sense != options_.placement.mirrors();
    face.loops = {LoopId{scene_.loops.size()}, static_cast<std::uint32_t>(plan.loops.size())};
    face.tolerance = kEdgeTolerance;
    for (const auto& loop : plan.loops) {
      for (const EdgeUse& use : loop) extend(face.uv_bounds, use.pcurve, plan_.edges[use.edge].range);
    }
    const bool reversed = !face.same_sense;
    scene_.faces.push_back(std::move(face));
    for (const auto& loop : plan.loops) enter_loop(loop, id, reversed);
  }

  void enter_loop(std::vector<EdgeUse> uses, FaceId face, bool reversed) {
    if (reversed) {
      std::reverse(uses.begin(), uses.end());
      for (EdgeUse& use : uses) use.forward = !use.forward;
    }
    const LoopId loop =
        scene_.loops.push_back({face, {HalfEdgeId{scene_.half_edges.size()}, static_cast<std::uint32_t>(uses.size())}});
    for (const EdgeUse& use : uses) {
      const EdgeId edge{first_edge_ + use.edge};
      const HalfEdgeId id =
          scene_.half_edges.push_back({edge, loop, use.forward, use.pcurve, plan_.edges[use.edge].range, HalfEdgeId{}});
      if (!plan_.edges[use.edge].degenerate) match_twin(edge, id);
    }
  }

  void match_twin(EdgeId edge, HalfEdgeId id) {
    const auto [other, fresh] = open_uses_.try_emplace(edge, id);
    if (fresh) return;
    HalfEdge& mine = scene_.half_edges[id];
    HalfEdge& theirs = scene_.half_edges[other->second];
    if (mine.forward == theirs.forward) throw std::logic_error("hand-built edge used twice in the same sense");
    mine.twin = other->second;
    theirs.twin = id;
    open_uses_.erase(other);
  }

  Scene& scene_;
  const SolidPlan& plan_;
  const SolidOptions& options_;
  std::size_t first_edge_;
  std::map<EdgeId, HalfEdgeId> open_uses_;
};

}  // namespace

SolidId enter(Scene& scene, const SolidPlan& plan, const SolidOptions& options) {
  return Entry(scene, plan, options).run();
}

}  // namespace lamella::test
