#include "model/trim_boundary.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "model/evaluate.h"
#include "model/rational_form.h"
#include "model/trim_chain.h"

namespace lamella {
namespace {

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

/// The pcurves of a loop end to begin, moved into one period; not closed yet.
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
  return chain;
}

bool has_area(const Box2& box) { return !box.isEmpty() && (box.sizes().array() > 0.0).all(); }

bool encloses_something(const Chain& chain) {
  Box2 box;
  for (const BezierCurve2& piece : chain) box.extend(control_box(piece));
  return has_area(box);
}

/// The whole of a closed surface or a spline; empty for surfaces without an end.
Box2 natural_bounds(const Surface& surface) {
  if (std::holds_alternative<Sphere>(surface)) return {Vec2(0.0, -0.5 * kPi), Vec2(kTwoPi, 0.5 * kPi)};
  if (std::holds_alternative<Torus>(surface)) return {Vec2(0.0, 0.0), Vec2(kTwoPi, kTwoPi)};
  const auto* spline = std::get_if<BSplineSurface>(&surface);
  if (const auto* fitted = std::get_if<FittedSurface>(&surface)) spline = &fitted->fit;
  if (spline == nullptr) return {};
  const Interval u = spline->domain_u();
  const Interval v = spline->domain_v();
  return {Vec2(u.lo, v.lo), Vec2(u.hi, v.hi)};
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
  std::vector<Chain> chains;
  for (const LoopId loop : face.loops) {
    Chain chain = chain_of(scene, loop);
    if (chain.empty()) continue;
    if (!face.same_sense) turn_round(chain);
    chains.push_back(std::move(chain));
  }
  TrimBoundary boundary;
  for (Chain& chain : close_chains(face, std::move(chains))) {
    if (encloses_something(chain)) append(boundary, std::move(chain));
  }
  if (boundary.pieces.empty()) {
    const Box2 whole = has_area(face.uv_bounds) ? face.uv_bounds : natural_bounds(face.surface);
    if (has_area(whole)) append(boundary, rectangle(whole));
  }
  return boundary;
}

}  // namespace lamella
