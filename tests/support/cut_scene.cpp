#include "tests/support/cut_scene.h"

#include <algorithm>
#include <cmath>

#include "model/measure.h"

namespace lamella::test {

namespace {

Vec2 axis_at(double angle) {
  const double quarters = angle / (0.5 * kPi);
  if (std::abs(quarters - std::round(quarters)) > 1e-12) return {std::cos(angle), std::sin(angle)};
  const Vec2 axes[4] = {Vec2::UnitX(), Vec2::UnitY(), -Vec2::UnitX(), -Vec2::UnitY()};
  return axes[(static_cast<long>(std::round(quarters)) % 4 + 4) % 4];
}

}  // namespace

RowLattice make_lattice(double angle, double anchor, double spacing, std::int64_t rows) {
  RowLattice lattice;
  lattice.along = axis_at(angle);
  lattice.across = Vec2(-lattice.along.y(), lattice.along.x());
  lattice.anchor = anchor;
  lattice.spacing = spacing;
  lattice.last_row = rows;
  return lattice;
}

RowLattice lattice_over(const Box3& box, double angle, std::int64_t rows, double shift) {
  RowLattice lattice = make_lattice(angle, 0.0, 1.0, rows);
  Interval reach{INFINITY, -INFINITY};
  for (int corner = 0; corner < 4; ++corner) {
    const Vec2 at(corner & 1 ? box.max().x() : box.min().x(), corner & 2 ? box.max().y() : box.min().y());
    reach.lo = std::min(reach.lo, lattice.across.dot(at));
    reach.hi = std::max(reach.hi, lattice.across.dot(at));
  }
  lattice.spacing = reach.length() / static_cast<double>(rows - 1);
  lattice.anchor = reach.lo + (shift - 1.0) * lattice.spacing;
  return lattice;
}

Ray ray_of(const RowLattice& lattice, std::int64_t row, double z) {
  Ray ray;
  ray.origin << lattice.position(row) * lattice.across, z;
  ray.direction << lattice.along, 0.0;
  return ray;
}

Box3 solid_box(const Scene& scene, SolidId solid) {
  Box3 box;
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId face : scene.shells[shell].faces) box.extend(exact_bounds(scene, face));
  }
  return box;
}

Box3 scene_box(const Scene& scene) {
  Box3 box;
  for (const SolidId solid : sound_solids(scene)) box.extend(solid_box(scene, solid));
  return box;
}

std::vector<SolidId> sound_solids(const Scene& scene) {
  std::vector<SolidId> solids;
  for (const SolidId id : scene.solids.ids()) {
    const SolidInfo& info = scene.solids[id].info;
    if (info.closed && info.status == SolidStatus::ok) solids.push_back(id);
  }
  return solids;
}

std::vector<SolidId> all_solids(const Scene& scene) {
  std::vector<SolidId> solids;
  for (const SolidId id : scene.solids.ids()) solids.push_back(id);
  return solids;
}

std::vector<LayerSpans> cut_layers(const SpanEngine& engine, const std::vector<LayerRequest>& requests) {
  std::vector<LayerSpans> layers(requests.size());
  for (std::size_t first = 0; first < requests.size(); first += kSlabLayers) {
    const std::size_t count = std::min(kSlabLayers, requests.size() - first);
    engine.cut(std::span(requests).subspan(first, count), std::span(layers).subspan(first, count));
  }
  return layers;
}

SpanRows cut_layer(const SpanEngine& engine, double z, const RowLattice& lattice, CastCounters* counters) {
  std::vector<LayerSpans> layers = cut_layers(engine, {{0, z, {lattice}}});
  if (counters != nullptr) *counters += layers.front().cast;
  return std::move(layers.front().lattices.front());
}

std::vector<Interval> spans_of(const SpanRows& rows, std::size_t row, SolidId solid) {
  std::vector<Interval> spans;
  for (const Span& span : rows.row(row)) {
    if (span.solid == solid) spans.push_back({span.begin, span.end});
  }
  return spans;
}

std::vector<Interval> spans_of_all(const SpanRows& rows) {
  std::vector<Interval> spans;
  for (const Span& span : rows.spans) spans.push_back({span.begin, span.end});
  return spans;
}

std::vector<Interval> merged(std::vector<Interval> spans, double slack) {
  std::erase_if(spans, [&](const Interval& span) { return span.length() <= slack; });
  std::sort(spans.begin(), spans.end(), [](const Interval& a, const Interval& b) { return a.lo < b.lo; });
  std::vector<Interval> result;
  for (const Interval& span : spans) {
    if (!result.empty() && span.lo <= result.back().hi + slack) {
      result.back().hi = std::max(result.back().hi, span.hi);
    } else {
      result.push_back(span);
    }
  }
  return result;
}

CastCounters total(const std::vector<LayerSpans>& layers) {
  CastCounters sum;
  for (const LayerSpans& layer : layers) sum += layer.cast;
  return sum;
}

}  // namespace lamella::test
