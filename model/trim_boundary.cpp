#include "model/trim_boundary.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "model/evaluate.h"
#include "model/rational_form.h"

namespace lamella {
namespace {

using Chain = std::vector<BezierCurve2>;

Vec2 begin_of(const BezierCurve2& piece) { return piece.net.front().head<2>() / piece.net.front()[2]; }
Vec2 end_of(const BezierCurve2& piece) { return piece.net.back().head<2>() / piece.net.back()[2]; }

BezierCurve2 straight(const Vec2& begin, const Vec2& end) {
  return {{0.0, 1.0}, {Vec3(begin[0], begin[1], 1.0), Vec3(end[0], end[1], 1.0)}};
}

void bridge(Chain& chain, const Vec2& to) {
  const Vec2 from = end_of(chain.back());
  if (from != to) chain.push_back(straight(from, to));
}

void move_by(Chain& chain, const Vec2& offset) {
  for (BezierCurve2& piece : chain) {
    for (Vec3& point : piece.net) point.head<2>() += point[2] * offset;
  }
}

void turn_round(Chain& chain) {
  std::reverse(chain.begin(), chain.end());
  for (BezierCurve2& piece : chain) piece = reversed(std::move(piece));
}

/// Pieces of one half-edge in the sense in which the loop runs through it.
Chain pieces_of(const Scene& scene, HalfEdgeId id) {
  const HalfEdge& half = scene.half_edges[id];
  try {
    Chain chain = rational_pieces(half.pcurve, half.prange);
    if (!half.forward) turn_round(chain);
    return chain;
  } catch (const GeometryError& error) {
    const Face& face = scene.faces[scene.loops[half.loop].face];
    const int entity = scene.edges[half.edge].step_entity;
    throw GeometryError(
        std::string(error.what()) + ", in an edge's curve in a face's parameters",
        std::string("face #") + std::to_string(face.step_entity) + std::string(", edge #") + std::to_string(entity),
        error.hint());
  }
}

/// Whole periods from `from` to `to`, per coordinate.
Vec2 whole_periods(const Vec2& from, const Vec2& to, const Vec2& period) {
  Vec2 result = Vec2::Zero();
  for (int i = 0; i < 2; ++i) {
    if (period[i] > 0.0) result[i] = period[i] * std::round((to[i] - from[i]) / period[i]);
  }
  return result;
}

/// At a pole or an apex all u are one point, and a step of a period along it is a true part of the loop.
bool is_degenerate_step(const Face& face, const Vec2& at, const Vec2& step) {
  const SurfacePoint point = evaluate(face.surface, at);
  const double length = (point.du * step[0] + point.dv * step[1]).norm();
  return length <= std::max(face.tolerance, 1e-6);
}

Chain chain_of(const Scene& scene, LoopId loop) {
  const Face& face = scene.faces[scene.loops[loop].face];
  const Vec2 period = periods(face.surface);
  Chain chain;
  for (const HalfEdgeId half : scene.loops[loop].half_edges) {
    Chain next = pieces_of(scene, half);
    if (next.empty()) continue;
    if (!chain.empty()) {
      const Vec2 end = end_of(chain.back());
      const Vec2 jump = whole_periods(begin_of(next.front()), end, period);
      if (!jump.isZero(0.0) && !is_degenerate_step(face, end, jump)) move_by(next, jump);
      bridge(chain, begin_of(next.front()));
    }
    chain.insert(chain.end(), std::make_move_iterator(next.begin()), std::make_move_iterator(next.end()));
  }
  if (!chain.empty()) bridge(chain, begin_of(chain.front()));
  return chain;
}

bool encloses_something(const Chain& chain) {
  Box2 box;
  for (const BezierCurve2& piece : chain) box.extend(control_box(piece));
  return !box.isEmpty() && (box.sizes().array() > 0.0).all();
}

Chain rectangle(const Box2& box) {
  const Vec2 corners[] = {box.min(), {box.max()[0], box.min()[1]}, box.max(), {box.min()[0], box.max()[1]}};
  Chain chain;
  for (int i = 0; i < 4; ++i) chain.push_back(straight(corners[i], corners[(i + 1) % 4]));
  return chain;
}

void append(TrimBoundary& boundary, Chain chain) {
  boundary.loop_begin.push_back(boundary.pieces.size());
  std::move(chain.begin(), chain.end(), std::back_inserter(boundary.pieces));
}

}  // namespace

TrimBoundary trim_boundary(const Scene& scene, FaceId id) {
  const Face& face = scene.faces[id];
  TrimBoundary boundary;
  for (const LoopId loop : face.loops) {
    Chain chain = chain_of(scene, loop);
    if (!encloses_something(chain)) continue;
    if (!face.same_sense) turn_round(chain);
    append(boundary, std::move(chain));
  }
  if (boundary.pieces.empty() && !face.uv_bounds.isEmpty()) append(boundary, rectangle(face.uv_bounds));
  return boundary;
}

}  // namespace lamella
