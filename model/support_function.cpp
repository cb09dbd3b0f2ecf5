#include "model/support_function.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <set>

#include "core/parallel.h"
#include "model/bounds.h"
#include "model/bspline.h"
#include "model/curve_extrema.h"
#include "model/evaluate.h"

namespace lamella {

namespace {

/// Largest value of direction . p in the box.
double reach_of(const Box3& box, const Vec3& direction) {
  return direction.dot(box.center()) + 0.5 * direction.cwiseAbs().dot(box.sizes());
}

/// The Bezier pieces of a curve, each a curve of its own.
std::vector<BSplineCurve<3>> pieces_of(const BSplineCurve<3>& curve) {
  const BSplineCurve<3> fine = refine(curve, bezier_knots(curve.knots, curve.degree));
  std::vector<BSplineCurve<3>> pieces;
  const int degree = fine.degree;
  for (int span = degree; span < static_cast<int>(fine.poles.size()); ++span) {
    const double lo = fine.knots[span];
    const double hi = fine.knots[span + 1];
    if (!(lo < hi)) continue;
    BSplineCurve<3> piece;
    piece.degree = degree;
    piece.knots.assign(degree + 1, lo);
    piece.knots.insert(piece.knots.end(), degree + 1, hi);
    piece.poles.assign(fine.poles.begin() + (span - degree), fine.poles.begin() + span + 1);
    if (!fine.weights.empty())
      piece.weights.assign(fine.weights.begin() + (span - degree), fine.weights.begin() + span + 1);
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace

SupportFunction::SupportFunction(const Scene& scene, std::span<const SolidId> solids, const Progress& progress,
                                 int threads) {
  std::set<EdgeId> edges;
  std::set<VertexId> vertices;
  std::vector<FaceId> curved;
  for (const SolidId solid : solids) {
    for (const ShellId shell : scene.solids[solid].shells) {
      for (const FaceId face : scene.shells[shell].faces) {
        if (may_exceed_border(scene.faces[face].surface)) curved.push_back(face);
        for (const LoopId loop : scene.faces[face].loops) {
          for (const HalfEdgeId use : scene.loops[loop].half_edges) edges.insert(scene.half_edges[use].edge);
        }
      }
    }
  }
  for (const EdgeId edge : edges) {
    if (scene.edges[edge].degenerate) {
      points_.push_back(scene.vertices[scene.edges[edge].start].point);
    } else {
      add_edge(scene, edge);
    }
  }
  add_faces(scene, curved, progress, threads);
  for (const Vec3& point : points_) bounds_.extend(point);
  for (const CurvedEdge& edge : edges_) bounds_.extend(edge.box);
  for (const CurvedFace& face : faces_) bounds_.extend(face.box);
}

void SupportFunction::add_edge(const Scene& scene, EdgeId id) {
  const Edge& edge = scene.edges[id];
  const auto add_point = [&](double t) { points_.push_back(evaluate<3>(edge.curve, t).point); };
  add_point(edge.range.lo);
  add_point(edge.range.hi);
  if (std::holds_alternative<Line<3>>(edge.curve)) return;
  const auto* spline = std::get_if<BSplineCurve<3>>(&edge.curve);
  if (spline == nullptr) {
    edges_.push_back({edge.curve, edge.range, exact_bounds(edge.curve, edge.range)});
    return;
  }
  for (BSplineCurve<3>& piece : pieces_of(*spline)) {
    const Interval range{std::max(edge.range.lo, piece.knots.front()), std::min(edge.range.hi, piece.knots.back())};
    if (!(range.lo < range.hi)) continue;
    if (range.lo > edge.range.lo) add_point(range.lo);
    if (piece.degree == 1) continue;
    Curve3 curve = std::move(piece);
    const Box3 box = exact_bounds(curve, range);
    edges_.push_back({std::move(curve), range, box});
  }
}

void SupportFunction::add_faces(const Scene& scene, std::span<const FaceId> faces, const Progress& progress,
                                int threads) {
  std::vector<std::optional<CurvedFace>> made(faces.size());
  std::atomic<std::size_t> done{0};
  parallel_for(
      faces.size(),
      [&](std::size_t i) {
        progress.throw_if_cancelled();
        made[i].emplace(CurvedFace{FaceExtent(scene, faces[i]), face_bounds(scene, faces[i]).box});
        progress.report("preparing heights", static_cast<double>(++done) / static_cast<double>(faces.size()));
      },
      threads);
  for (auto& face : made) {
    if (!face->box.isEmpty()) faces_.push_back(std::move(*face));
  }
}

Reach SupportFunction::operator()(const Vec3& direction, const Vec3* hint) const {
  Reach best;
  if (hint != nullptr) best.raise(direction.dot(*hint), *hint);
  for (const Vec3& point : points_) best.raise(direction.dot(point), point);
  for (const CurvedEdge& edge : edges_) {
    if (!(reach_of(edge.box, direction) > best.value)) continue;
    const Interval known{-std::numeric_limits<double>::infinity(), best.value};
    for (const double t : critical_parameters(edge.curve, edge.range, direction, &known)) {
      const Vec3 point = evaluate<3>(edge.curve, t).point;
      best.raise(direction.dot(point), point);
    }
  }
  for (const CurvedFace& face : faces_) {
    if (reach_of(face.box, direction) > best.value) face.extent.raise(direction, best);
  }
  return best;
}

double SupportFunction::width(const Vec3& direction) const {
  return (*this)(direction).value + (*this)(-direction).value;
}

double SupportFunction::accuracy() const { return bounds_.isEmpty() ? 0.0 : 2e-9 * bounds_.diagonal().norm(); }

}  // namespace lamella
