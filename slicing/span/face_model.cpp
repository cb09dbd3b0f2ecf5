#include "slicing/span/face_model.h"

#include <algorithm>
#include <cmath>

#include "model/critical_points.h"
#include "model/evaluate.h"
#include "model/iso_line.h"
#include "model/trim_chain.h"
#include "slicing/span/round_section.h"

namespace lamella::span {

namespace {

constexpr double kOverreach = 1e-9;  // mm, of a cut beyond the face's border

constexpr int kLoopSamples = 12;  // a half-edge, to find a loop's sense and reach

/// What the loops of a face look like in its chart.
struct LoopShape {
  double area = 0.0;  ///< signed, in the surface's sense
  Vec2 rightmost = Vec2::Zero();
  Box2 box;
};

Vec2 pcurve_point(const HalfEdge& half, double part) {
  return evaluate<2>(half.pcurve, half.prange.lo + part * half.prange.length()).point;
}

/// The circle or curve v = const of a surface, by u; nothing for planes.
std::optional<Curve3> iso_v_curve(const Surface& surface, double v) {
  if (const auto* spline = std::get_if<BSplineSurface>(&surface)) return Curve3(iso_curve(*spline, false, v));
  if (const auto* fitted = std::get_if<FittedSurface>(&surface)) return Curve3(iso_curve(fitted->fit, false, v));
  if (std::holds_alternative<Plane>(surface)) return std::nullopt;
  if (const auto* extrusion = std::get_if<Extrusion>(&surface)) {
    const Vec3 offset = v * extrusion->direction;
    return std::visit(
        [&](auto curve) {
          using T = decltype(curve);
          if constexpr (std::is_same_v<T, Line<3>>) curve.origin += offset;
          if constexpr (std::is_same_v<T, Parabola<3>>) curve.apex += offset;
          if constexpr (std::is_same_v<T, Ellipse<3>> || std::is_same_v<T, Hyperbola<3>>) curve.center += offset;
          if constexpr (std::is_same_v<T, BSplineCurve<3>>) {
            for (Vec3& pole : curve.poles) pole += offset;
          }
          return Curve3(std::move(curve));
        },
        extrusion->basis);
  }
  // The rest are of revolution: a circle through the points at u = 0, pi / 2 and pi.
  const Vec3 a = evaluate_point(surface, {0.0, v});
  const Vec3 b = evaluate_point(surface, {0.5 * kPi, v});
  const Vec3 c = evaluate_point(surface, {kPi, v});
  const Vec3 center = 0.5 * (a + c);
  return Curve3(Ellipse<3>{center, a - center, b - center});
}

class Builder {
 public:
  Builder(const Scene& scene, const EdgePieces& edges, FaceModel& model)
      : scene_(scene), edges_(edges), face_(scene.faces[model.id]), model_(model) {}

  void build() {
    for (const LoopId loop : face_.loops) add_loop(loop);
    if (model_.uses.empty() && heights_.empty()) return;
    if (model_.kind == SectionKind::traced) add_critical_points();
    if (model_.kind == SectionKind::round) add_round_ends();
    finish_events();
  }

 private:
  void add_loop(LoopId loop) {
    LoopShape shape;
    Vec2 end;
    Vec2 last_sample;
    Vec2 first_begin = Vec2::Zero();
    bool is_first = true;
    const auto number = static_cast<std::uint32_t>(shapes_.size());
    for (const HalfEdgeId id : scene_.loops[loop].half_edges) {
      const HalfEdge& half = scene_.half_edges[id];
      const Vec2 begin = pcurve_point(half, half.forward ? 0.0 : 1.0);
      Vec2 offset = Vec2::Zero();
      if (!is_first) {
        offset = whole_periods(begin, end, model_.surface.periods());
        if (!offset.isZero(0.0) && is_degenerate_step(face_, end, offset)) offset.setZero();
      }
      for (int i = 0; i <= kLoopSamples; ++i) {
        const double part = static_cast<double>(i) / kLoopSamples;
        const Vec2 uv = pcurve_point(half, half.forward ? part : 1.0 - part) + offset;
        if (is_first && i == 0) shape.rightmost = last_sample = first_begin = uv;
        shape.area += 0.5 * (last_sample[0] * uv[1] - last_sample[1] * uv[0]);
        if (uv[0] > shape.rightmost[0]) shape.rightmost = uv;
        shape.box.extend(uv);
        last_sample = uv;
      }
      end = last_sample;
      is_first = false;
      add_uses(id, offset, number);
    }
    if (is_first) return;
    has_ring_ = has_ring_ || !whole_periods(first_begin, end, model_.surface.periods()).isZero(0.0);
    if (!face_.same_sense) shape.area = -shape.area;
    shapes_.push_back(shape);
  }

  void add_uses(HalfEdgeId id, const Vec2& offset, std::uint32_t loop) {
    const HalfEdge& half = scene_.half_edges[id];
    const Edge& edge = scene_.edges[half.edge];
    heights_.push_back(scene_.vertices[edge.start].point.z());
    extend(scene_.vertices[edge.start].point);
    extend(scene_.vertices[edge.end].point);
    if (edge.degenerate) return;
    const auto [first, last] = edges_.of(half.edge);
    const auto pcurve = static_cast<std::uint32_t>(model_.pcurves.size());
    model_.pcurves.emplace_back(half.pcurve);
    for (std::uint32_t i = 0; i < last - first; ++i) {
      const std::uint32_t piece = half.forward ? first + i : last - 1 - i;
      const MonotonePiece& range = edges_.all()[piece].range;
      heights_.push_back(range.z0);
      heights_.push_back(range.z1);
      extend(evaluate<3>(edge.curve, 0.5 * (range.t0 + range.t1)).point);
      if (range.z0 == range.z1) continue;
      model_.uses.push_back({piece, id, pcurve, offset, range.rises() == half.forward, loop});
    }
  }

  void extend(const Vec3& point) { box_.extend(point); }

  Box2 chart() const {
    Box2 box;
    for (const LoopShape& shape : shapes_) box.extend(shape.box);
    return box;
  }

  void add_critical_points() {
    const Box2 bounds = chart();
    if (bounds.isEmpty()) return;
    const CriticalPoints critical = find_critical_points(face_.surface, bounds);
    model_.complete = critical.complete;
    heights_.insert(heights_.end(), critical.levels.begin(), critical.levels.end());
    const bool has_holes = std::any_of(shapes_.begin(), shapes_.end(), [](const LoopShape& s) { return s.area < 0.0; });
    if (critical.points.empty() && !has_holes) return;
    model_.region.emplace(scene_, model_.id);
    for (const CriticalPoint& point : critical.points) {
      if (model_.region->classify(point.uv, 1e-9 * bounds.sizes()) == TrimRegion::Side::outside) continue;
      heights_.push_back(point.z);
      if (point.kind != CriticalKind::saddle) add_cut(point.uv, bounds);
      if (point.kind == CriticalKind::saddle || point.kind == CriticalKind::flat) {
        model_.passes.push_back({evaluate_point(face_.surface, point.uv).head<2>(), point.z});
      }
    }
    for (const LoopShape& shape : shapes_) {
      if (shape.area < 0.0) add_cut(shape.rightmost, bounds);
    }
  }

  void add_cut(const Vec2& from, const Box2& bounds) {
    const double end = bounds.max()[0];
    if (!(end > from[0])) return;
    auto curve = iso_v_curve(face_.surface, from[1]);
    if (!curve) return;
    CutLine cut{SectionCurve<3>(*curve), from[1], {}};
    const double z_begin = evaluate_point(face_.surface, from).z();
    const double z_end = evaluate_point(face_.surface, {end, from[1]}).z();
    cut.pieces = monotone_pieces(*curve, {from[0], end}, z_begin, z_end);
    // It ends on the face's border, whose stored height may differ in the last bits: reach over it.
    MonotonePiece& last = cut.pieces.back();
    last.z1 += last.rises() ? kOverreach : -kOverreach;
    for (const MonotonePiece& piece : cut.pieces) {
      cut_heights_.push_back(piece.z0);
      cut_heights_.push_back(piece.z1);
    }
    model_.cuts.push_back(std::move(cut));
  }

  void add_round_ends() {
    const auto* sphere = std::get_if<Sphere>(&face_.surface);
    const auto* torus = std::get_if<Torus>(&face_.surface);
    // Without a seam a whole ellipse may touch no edge.
    if (sphere != nullptr || has_ring_) model_.region.emplace(scene_, model_.id);
    if (torus != nullptr) {
      for (const double side : {-1.0, 1.0}) heights_.push_back(torus->frame.origin.z() + side * torus->minor_radius);
    }
    if (sphere == nullptr) return;
    for (const double side : {-1.0, 1.0}) {
      const double z = sphere->frame.origin.z() + side * sphere->radius;
      const Vec2 pole = round_parameters(face_.surface, z, false, 0.0);
      if (model_.region->classify(pole, Vec2::Constant(1e-9)) != TrimRegion::Side::outside) heights_.push_back(z);
    }
  }

  void finish_events() {
    const auto [lowest, highest] = std::minmax_element(heights_.begin(), heights_.end());
    const double low = *lowest;
    const double high = *highest;
    // A cut reaches beyond the face's border: its heights there are of no concern.
    for (const double z : cut_heights_) {
      if (z > low && z < high) heights_.push_back(z);
    }
    std::sort(heights_.begin(), heights_.end());
    // Heights that differ in the last bit stay apart: crossings are decided by exact comparison.
    heights_.erase(std::unique(heights_.begin(), heights_.end()), heights_.end());
    model_.events = std::move(heights_);
    model_.size = box_.isEmpty() ? 0.0 : box_.diagonal().norm();
  }

  const Scene& scene_;
  const EdgePieces& edges_;
  const Face& face_;
  FaceModel& model_;
  std::vector<LoopShape> shapes_;
  std::vector<double> heights_;
  std::vector<double> cut_heights_;
  Box3 box_;
  bool has_ring_ = false;  ///< a loop runs once round the surface: the face has no seam
};

SectionKind kind_of(const Surface& surface) {
  if (std::holds_alternative<Plane>(surface)) return SectionKind::plane;
  if (has_round_sections(surface)) return SectionKind::round;
  return SectionKind::traced;
}

}  // namespace

EdgePieces::EdgePieces(const Scene& scene, SolidId solid) {
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId face : scene.shells[shell].faces) {
      for (const LoopId loop : scene.faces[face].loops) {
        for (const HalfEdgeId half : scene.loops[loop].half_edges) {
          const EdgeId id = scene.half_edges[half].edge;
          const Edge& edge = scene.edges[id];
          if (edge.degenerate || ranges_.contains(id)) continue;
          const auto first = static_cast<std::uint32_t>(pieces_.size());
          const double z_start = scene.vertices[edge.start].point.z();
          const double z_end = scene.vertices[edge.end].point.z();
          for (const MonotonePiece& piece : monotone_pieces(edge.curve, edge.range, z_start, z_end)) {
            pieces_.push_back({id, static_cast<std::uint32_t>(curves_.size()), piece});
          }
          curves_.emplace_back(edge.curve);
          ranges_[id] = {first, static_cast<std::uint32_t>(pieces_.size())};
        }
      }
    }
  }
}

std::pair<std::uint32_t, std::uint32_t> EdgePieces::of(EdgeId edge) const {
  const auto found = ranges_.find(edge);
  return found == ranges_.end() ? std::pair<std::uint32_t, std::uint32_t>{0, 0} : found->second;
}

FaceModel::FaceModel(const Scene& scene, FaceId face, const EdgePieces& edges)
    : id(face), kind(kind_of(scene.faces[face].surface)), surface(scene.faces[face].surface) {
  sign = scene.faces[face].same_sense ? 1.0 : -1.0;
  tolerance = scene.faces[face].tolerance;
  Builder(scene, edges, *this).build();
}

std::optional<std::size_t> FaceModel::band_of(double z) const {
  const auto above = std::upper_bound(events.begin(), events.end(), z);
  if (above == events.begin() || above == events.end()) return std::nullopt;
  return static_cast<std::size_t>(above - events.begin()) - 1;
}

}  // namespace lamella::span
