#include "slicing/span/face_section.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/evaluate.h"

namespace lamella::span {

namespace {

/// A layer this near to a change of topology is cut this far inside its band: there the section may be singular.
constexpr double kEventMargin = 1e-8;  // mm

/// Of a unit normal: where its horizontal part is shorter, it says nothing of the section's direction.
constexpr double kFlat = 1e-6;

/// The point of the section near `uv`, as the cell sees it that the section enters there. `at` is the surface in `uv`,
/// seen from `cell`.
std::optional<SectionPoint> starting_point(const SectionSurface& surface, const Cell& cell, const SurfacePoint2& at,
                                           const Vec2& uv, double z, double sign, const CorrectLimits& limits) {
  const auto point = correct(surface, cell, uv, z, sign, -1, limits, &at);
  if (!point) return point;
  const Cell ahead = surface.find_cell(point->uv, point->uv_slope);
  if (ahead == cell) return point;
  const auto again = correct(surface, ahead, point->uv, z, sign, -1, limits);
  return again ? again : point;
}

}  // namespace

FaceSection::FaceSection(const Scene& scene, const FaceModel& face, const EdgePieces& edges, const TraceLimits& limits,
                         std::span<const double> heights)
    : scene_(&scene), face_(&face), edges_(&edges), limits_(limits), heights_(heights) {
  limits_.longest = std::max(0.5 * face.size, 1e-6);
}

void FaceSection::cut(std::size_t layer, NodeTable& nodes, Section& out) {
  layer_ = layer;
  const double z = heights_[layer];
  const auto band = face_->band_of(z);
  if (!band) return;
  entered_ = band != band_;
  if (entered_) enter_band(*band, z, nodes);
  switch (face_->kind) {
    case SectionKind::plane:
      cut_plane(z, nodes, out);
      break;
    case SectionKind::round:
      cut_round(z, nodes, out);
      break;
    case SectionKind::traced:
      cut_traced(z, nodes, out);
      break;
  }
  last_z_ = z;
}

double FaceSection::inner_height(double z) const {
  const double low = face_->events[*band_];
  const double high = face_->events[*band_ + 1];
  const double margin = std::min(kEventMargin, 0.25 * (high - low));
  return std::clamp(z, low + margin, high - margin);
}

void FaceSection::cut_plane(double z, NodeTable& nodes, Section& out) const {
  const auto& plane = std::get<Plane>(face_->surface.surface());
  const Vec3 normal = plane.frame.x.cross(plane.frame.y);
  const double flat = normal.head<2>().squaredNorm();
  const auto onto = [&](const Vec2& xy) -> Vec2 {
    if (flat < 1e-12) return xy;
    const double off = normal.dot(Vec3(xy.x(), xy.y(), z) - plane.frame.origin);
    return xy - normal.head<2>() * (off / flat);
  };
  const Vec2 horizontal = flat < kFlat * kFlat ? Vec2(Vec2::Zero()) : Vec2(face_->sign * normal.head<2>());
  for (const Family& family : families_) {
    const Vec2 begin = nodes.node(face_->uses[family.begin].piece).xy;
    const Vec2 end = nodes.node(face_->uses[family.end].piece).xy;
    append_chord(begin, end, onto(begin), onto(end), false, out);
    out.arcs.back().begin_normal = out.arcs.back().end_normal = horizontal;
  }
}

void FaceSection::cut_round(double z, NodeTable& nodes, Section& out) {
  for (Family& family : families_) {
    const bool is_loop = family.cut >= 0;
    EllipseArc arc{round_section(face_->surface.surface(), z, family.inner)};
    SectionArc section_arc{face_->id, {}, {}, static_cast<std::uint32_t>(out.pieces.size())};
    if (is_loop) {
      arc.sweep = family.turn * kTwoPi;
      section_arc.begin = section_arc.end = arc.ellipse.at(0.0);
    } else {
      section_arc.begin = nodes.node(face_->uses[family.begin].piece).xy;
      section_arc.end = nodes.node(face_->uses[family.end].piece).xy;
      arc.begin = arc.ellipse.angle_of(section_arc.begin);
      arc.sweep = family.turn * follow_sweep(family, z, nodes);
    }
    (limits_.ellipses ? section_arc.ellipse : section_arc.round) = static_cast<std::int32_t>(out.ellipses.size());
    out.ellipses.push_back(arc);
    if (!limits_.ellipses) {
      append_pieces(arc, limits_.tolerance, out.pieces);
      section_arc.piece_count = static_cast<std::uint32_t>(out.pieces.size()) - section_arc.first_piece;
    }
    out.arcs.push_back(section_arc);
    if (!is_loop) note_normals(family, out.arcs.size() - 1, z, nodes, out);
  }
}

namespace {

/// Puts the normals of an arc's nodes where those of its pieces begin and end that were followed.
void put_normals(const Vec2& begin_normal, const Vec2& end_normal, std::size_t first, Section& out) {
  const auto is_followed = [](const SectionArc& arc) { return !arc.straight; };
  const auto begin = std::find_if(out.arcs.begin() + static_cast<std::ptrdiff_t>(first), out.arcs.end(), is_followed);
  if (begin == out.arcs.end()) return;
  const auto end = std::find_if(out.arcs.rbegin(), out.arcs.rend(), is_followed);
  begin->begin_normal = begin_normal;
  end->end_normal = end_normal;
}

}  // namespace

void FaceSection::note_normals(const Family& family, std::size_t first, double z, NodeTable& nodes,
                               Section& out) const {
  // What was cut within the band, not on the layer, may turn on the little way to its nodes.
  if (inner_height(z) != z) return;
  put_normals(node_normal(family.begin, nodes), node_normal(family.end, nodes), first, out);
}

void FaceSection::note_normals(const FacePoint& begin, const FacePoint& end, std::size_t first, double z,
                               Section& out) const {
  if (inner_height(z) == z) put_normals(begin.normal, end.normal, first, out);
}

Vec2 FaceSection::node_normal(std::uint32_t use, NodeTable& nodes) const {
  const PieceUse& piece_use = face_->uses[use];
  const Vec2 uv = chart_point(piece_use, nodes.node(piece_use.piece));
  const Cell cell = face_->surface.find_cell(uv, Vec2::Zero());
  return horizontal_normal(face_->surface.evaluate_slopes(uv, cell), cell, uv);
}

Vec2 FaceSection::horizontal_normal(const SurfacePoint& at, const Cell& cell, const Vec2& uv) const {
  if (face_->surface.is_near_limit(cell, uv)) return Vec2::Zero();
  const Vec3 normal = face_->sign * at.normal();
  const double length = normal.norm();
  return normal.head<2>().norm() > kFlat * length ? Vec2(normal.head<2>() / length) : Vec2(Vec2::Zero());
}

double FaceSection::chart_angle(const PieceUse& use, const Node& node, const PlaneEllipse& ellipse) const {
  const double angle = ellipse.angle_of(node.xy);
  if (std::holds_alternative<Sphere>(face_->surface.surface())) return angle;
  const double chart = chart_point(use, node)[0];
  return angle + kTwoPi * std::round((chart - angle) / kTwoPi);
}

double FaceSection::sweep_between(const Family& family, double z, const Node& begin, const Node& end) const {
  const PlaneEllipse ellipse = round_section(face_->surface.surface(), z, family.inner);
  return family.turn *
         (chart_angle(face_->uses[family.end], end, ellipse) - chart_angle(face_->uses[family.begin], begin, ellipse));
}

double FaceSection::follow_sweep(Family& family, double z, NodeTable& nodes) const {
  const std::uint32_t begin = face_->uses[family.begin].piece;
  const std::uint32_t end = face_->uses[family.end].piece;
  const auto turned = [&](double raw) { return raw + kTwoPi * std::round((family.sweep - raw) / kTwoPi); };
  if (std::holds_alternative<Sphere>(face_->surface.surface())) {
    // Angles about a sphere know no chart: the sweep is followed, continuous in z, from where it was known.
    const double band = face_->events[*band_ + 1] - face_->events[*band_];
    const int steps = std::clamp(static_cast<int>(std::ceil(16.0 * std::abs(z - family.z) / band)), 1, 16);
    const double from = family.z;
    for (int i = 1; i < steps; ++i) {
      const double here = from + (z - from) * i / steps;
      family.sweep = turned(sweep_between(family, here, nodes.node_at(begin, here), nodes.node_at(end, here)));
    }
    family.z = z;
    family.sweep = turned(sweep_between(family, z, nodes.node(begin), nodes.node(end)));
    return family.sweep;
  }
  return sweep_between(family, z, nodes.node(begin), nodes.node(end)) + family.sweep;
}

Vec2 FaceSection::chart_point(const PieceUse& use, const Node& node) const {
  const HalfEdge& half = scene_->half_edges[use.half_edge];
  const Edge& edge = scene_->edges[half.edge];
  const double part = (node.t - edge.range.lo) / edge.range.length();
  return face_->pcurves[use.pcurve].evaluate(half.prange.lo + part * half.prange.length()).point + use.offset;
}

FaceSection::FacePoint FaceSection::face_point(const PieceUse& use, const Node& node, double z) const {
  const HalfEdge& half = scene_->half_edges[use.half_edge];
  const Edge& edge = scene_->edges[half.edge];
  FacePoint result;
  result.node = node.xy;
  result.tolerance = std::max(edge.tolerance, 1e-7);
  const Vec2 uv = chart_point(use, node);
  result.chart = uv;
  result.piece = use.piece;
  const CorrectLimits limits{std::max(20.0 * result.tolerance, 1e-3 * face_->size)};
  const Cell cell = face_->surface.find_cell(uv, Vec2::Zero());
  const SurfacePoint2 at = face_->surface.evaluate(uv, cell);
  result.normal = horizontal_normal(at, cell, uv);
  if (const auto point = starting_point(face_->surface, cell, at, uv, z, face_->sign, limits)) {
    result.point = *point;
    result.point.z = z;
    result.usable = true;
  } else {
    result.point.uv = uv;
    result.point.xy = node.xy;
    result.point.z = z;
  }
  return result;
}

FaceSection::FacePoint FaceSection::cut_point(const Family& family, double z) const {
  const CutLine& cut = face_->cuts[static_cast<std::size_t>(family.cut)];
  const double u = find_crossing(cut.curve, cut.pieces[family.cut_piece], z, std::nan("")).t;
  FacePoint result;
  result.chart = Vec2(u, cut.v);
  const CorrectLimits limits{1e-3 * face_->size};
  const Cell cell = face_->surface.find_cell(result.chart, Vec2::Zero());
  const SurfacePoint2 at = face_->surface.evaluate(result.chart, cell);
  const auto point = starting_point(face_->surface, cell, at, result.chart, z, face_->sign, limits);
  result.usable = point.has_value();
  if (point) result.point = *point;
  result.point.z = z;
  result.node = result.point.xy;
  return result;
}

bool FaceSection::lie_together(const FacePoint& begin, const FacePoint& end) const {
  // The twins of a seam lie together in space but a period, or the length of a closed spline, apart in the chart.
  if (begin.piece == end.piece) return false;
  const Vec2 step = (end.chart - begin.chart).cwiseAbs();
  for (int axis = 0; axis < 2; ++axis) {
    if (step[axis] > 0.25 * face_->surface.extent(axis)) return false;
  }
  return true;
}

bool FaceSection::are_joined(const FacePoint& begin, const FacePoint& end, std::span<const SectionPoint> ends) {
  const Vec2 step = end.point.xy - begin.point.xy;
  const double distance = step.norm();
  if (distance > 2.0 * std::max(begin.tolerance, end.tolerance)) return false;
  if (!lie_together(begin, end)) return false;
  if (length_of(begin.point, end.point.uv - begin.point.uv) > 10.0 * distance + 1e-6) return false;
  if (step.dot(begin.point.tangent) > 0.0) return distance <= 1e-7;
  // The end lies behind: inverted, or the two ends of an arc that has nearly closed to a loop.
  return !leads_to(begin, ends);
}

bool FaceSection::leads_to(const FacePoint& begin, std::span<const SectionPoint> ends) {
  if (!trace(face_->surface, face_->sign, begin.point, ends, limits_, traced_)) return false;
  // What is inverted runs outside the face.
  for (std::size_t i = 1; i + 1 < traced_.points.size(); ++i) {
    const SectionPoint& point = traced_.points[i];
    const Vec2 slack = begin.tolerance * Vec2(1.0 / std::sqrt(point.metric[0]), 1.0 / std::sqrt(point.metric[2]));
    if (region().classify(point.uv, slack) == TrimRegion::Side::outside) return false;
  }
  return traced_.points.size() > 2;
}

const TrimRegion& FaceSection::region() {
  if (face_->region) return *face_->region;
  if (!own_region_) own_region_.emplace(*scene_, face_->id);
  return *own_region_;
}

bool FaceSection::cut_by_sheet(Family& family, double inner, NodeTable& nodes, Section& out) const {
  if (!family.sheet.covers(inner)) return false;
  const auto first = static_cast<std::uint32_t>(out.pieces.size());
  const auto count = static_cast<std::uint32_t>(family.sheet.piece_count());
  out.pieces.resize(first + count);
  family.sheet.evaluate(inner, out.pieces.data() + first);
  if (family.cut < 0 && !keeps_to_nodes(family, out.pieces.data() + first, count, nodes)) {
    out.pieces.resize(first);
    family.sheet.clear();
    // An edge with a knot in this run is likely to have one in the next.
    family.next_sheet = heights_.size();
    return false;
  }
  if (family.cut >= 0) {
    const Vec2 seed = out.pieces[first].at(0.0);
    append_range(seed, seed, first, out);
  } else {
    append_range(nodes.node(face_->uses[family.begin].piece).xy, nodes.node(face_->uses[family.end].piece).xy, first,
                 out);
  }
  return true;
}

bool FaceSection::keeps_to_nodes(const Family& family, const ArcPiece* pieces, std::uint32_t count,
                                 NodeTable& nodes) const {
  const Vec2 begin = nodes.node(face_->uses[family.begin].piece).xy - pieces[0].at(0.0);
  const Vec2 end = nodes.node(face_->uses[family.end].piece).xy - pieces[count - 1].at(1.0);
  const double allowed = family.sheet.gap() + 4.0 * limits_.tolerance;
  return begin.squaredNorm() <= allowed * allowed && end.squaredNorm() <= allowed * allowed;
}

void FaceSection::try_sheet(Family& family, double inner, const NodeTable& nodes) {
  if (family.carried.empty() || family.carried.z != inner || layer_ < family.next_sheet) return;
  std::size_t last = layer_;
  while (last + 1 < heights_.size() && heights_[last + 1] < face_->events[*band_ + 1]) ++last;
  double gap = 0.0;
  const auto ends_at = [&](double z, SectionPoint& begin, SectionPoint& end) {
    if (family.cut >= 0) {
      const FacePoint seed = cut_point(family, z);
      begin = end = seed.point;
      return seed.usable;
    }
    const PieceUse& begin_use = face_->uses[family.begin];
    const PieceUse& end_use = face_->uses[family.end];
    const FacePoint from = face_point(begin_use, nodes.node_at(begin_use.piece, z), z);
    const FacePoint to = face_point(end_use, nodes.node_at(end_use.piece, z), z);
    begin = from.point;
    end = to.point;
    gap = std::max({gap, (from.node - begin.xy).norm(), (to.node - end.xy).norm()});
    return from.usable && to.usable;
  };
  std::size_t layers = last - layer_ + 1;
  const double highest = inner + Sheet::kFarthest / family.carried.speed();
  while (layers >= Sheet::kFewestLayers && heights_[layer_ + layers - 1] > highest) --layers;
  while (layers >= Sheet::kFewestLayers) {
    const double high = inner_height(heights_[layer_ + layers - 1]);
    const double error = family.sheet.build(face_->surface, face_->sign, inner, high, limits_, ends_at, family.carried);
    if (error <= 1.0) {
      family.sheet.allow_gap(gap);
      return;
    }
    // The error grows with the fifth power of the run's height.
    if (std::isinf(error)) break;
    layers = static_cast<std::size_t>(std::min(0.9, 0.9 * std::pow(error, -0.2)) * static_cast<double>(layers));
  }
  // What bends too much for a sheet here will do so a little further up.
  family.next_sheet = heights_.size();
}

FaceSection::FacePoint FaceSection::layer_point(std::uint32_t use, double z, double inner, NodeTable& nodes) const {
  const PieceUse& piece_use = face_->uses[use];
  const Node& stored = nodes.node(piece_use.piece);
  // At the very height of an event the face may be horizontal in a node, where nothing can be traced from.
  FacePoint point = face_point(piece_use, inner == z ? stored : nodes.node_at(piece_use.piece, inner), inner);
  point.node = stored.xy;
  return point;
}

void FaceSection::cut_traced(double z, NodeTable& nodes, Section& out) {
  const double inner = inner_height(z);
  end_points_.resize(1);  // the first place is for the seed of a loop
  is_known_.resize(1);
  for (Family& family : families_) {
    const std::size_t first = out.arcs.size();
    if (cut_by_sheet(family, inner, nodes, out)) {
      if (family.cut < 0) note_normals(family, first, z, nodes, out);
      continue;
    }
    if (family.cut >= 0) {
      cut_loop(family, inner, out);
      try_sheet(family, inner, nodes);
      continue;
    }
    const FacePoint begin = layer_point(family.begin, z, inner, nodes);
    const FacePoint end = layer_point(family.end, z, inner, nodes);
    const bool is_known = cut_arc(family, begin, end, out);
    note_normals(begin, end, first, z, out);
    if (entered_ && end.usable) {
      end_points_.push_back(end.point);
      is_known_.push_back(is_known ? 1 : 0);
    }
    try_sheet(family, inner, nodes);
  }
  if (entered_ && !face_->cuts.empty()) {
    const std::size_t known = families_.size();
    find_loops(inner, out);
    for (std::size_t i = known; i < families_.size(); ++i) cut_loop(families_[i], inner, out);
  }
}

bool FaceSection::cut_arc(Family& family, const FacePoint& begin, const FacePoint& end, Section& out) {
  if (!begin.usable || !end.usable) {
    family.carried.arc.clear();
    append_chord(begin.node, end.node, begin.point.xy, end.point.xy, true, out);
    return false;
  }
  CarriedArc& carried = family.carried;
  const double z = begin.point.z;
  if (!carried.empty() && carried.z == z) {
    append(begin.node, end.node, carried.arc.pieces, out);
    return true;
  }
  if (are_joined(begin, end, {&end.point, 1})) {
    family.carried.arc.clear();
    append_chord(begin.node, end.node, begin.point.xy, end.point.xy, false, out);
    return true;
  }
  if (!carried.empty() &&
      carry(face_->surface, face_->sign, begin.point, end.point, z, limits_, true, work_, carried)) {
    append(begin.node, end.node, carried.arc.pieces, out);
    return true;
  }
  const std::size_t twin = begin.piece == end.piece ? 0 : kNoTwin;
  if (trace(face_->surface, face_->sign, begin.point, {&end.point, 1}, limits_, carried.arc, twin)) {
    carried.start(z);
    append(begin.node, end.node, carried.arc.pieces, out);
    return true;
  }
  std::swap(traced_, carried.arc);
  carried.arc.clear();
  bridge(begin, end, out);
  return false;
}

void FaceSection::bridge(const FacePoint& begin, const FacePoint& end, Section& out) {
  // traced_ holds what could be followed from the beginning; the same from the end, backward.
  const Cell cell = face_->surface.find_cell(end.point.uv, -end.point.uv_slope);
  SectionPoint back = section_point(face_->surface.evaluate(end.point.uv, cell), end.point.uv, -face_->sign);
  back.z = end.point.z;
  trace(face_->surface, -face_->sign, back, {}, limits_, backward_);
  std::size_t from = 0;
  std::size_t to = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < traced_.points.size(); ++i) {
    for (std::size_t j = 0; j < backward_.points.size(); ++j) {
      const double distance = (traced_.points[i].xy - backward_.points[j].xy).squaredNorm();
      if (distance < least) {
        least = distance;
        from = i;
        to = j;
      }
    }
  }
  const SectionPoint& a = traced_.points[from];
  const SectionPoint& b = backward_.points[to];
  traced_.pieces.resize(from);
  const Vec2 first = from == 0 ? begin.node : a.xy;
  const Vec2 second = to == 0 ? end.node : b.xy;
  if (from > 0) append(begin.node, first, traced_.pieces, out);
  // The twins of a seam lie together, but the arc between them goes all the way round.
  const bool is_round = begin.piece == end.piece;
  const bool doubtful = is_round || !(height_off(a, b) <= std::max(begin.tolerance, end.tolerance));
  // The chord between twins has no length and meets no row: what is missing must be counted here.
  if (is_round) out.lost_loops.push_back(face_->id);
  append_chord(first, second, a.xy, b.xy, doubtful, out);
  if (to == 0) return;
  traced_.pieces.clear();
  for (std::size_t j = to; j-- > 0;) traced_.pieces.push_back(reversed(backward_.pieces[j]));
  append(second, end.node, traced_.pieces, out);
}

double FaceSection::height_off(const SectionPoint& a, const SectionPoint& b) const {
  const Vec2 middle = 0.5 * (a.uv + b.uv);
  const Cell cell = face_->surface.find_cell(middle, Vec2::Zero());
  const SurfacePoint2 at = face_->surface.evaluate(middle, cell);
  const Vec3 off = at.point - Vec3(0.5 * (a.xy.x() + b.xy.x()), 0.5 * (a.xy.y() + b.xy.y()), a.z);
  return std::abs(off.dot(at.normal().normalized()));
}

void FaceSection::cut_loop(Family& family, double z, Section& out) {
  const FacePoint seed = cut_point(family, z);
  CarriedArc& carried = family.carried;
  if (seed.usable && !carried.empty() &&
      (carried.z == z ||
       carry(face_->surface, face_->sign, seed.point, seed.point, z, limits_, true, work_, carried))) {
    append(seed.node, seed.node, carried.arc.pieces, out);
    return;
  }
  if (seed.usable && trace(face_->surface, face_->sign, seed.point, {&seed.point, 1}, limits_, carried.arc)) {
    carried.start(z);
    append(seed.node, seed.node, carried.arc.pieces, out);
  } else {
    carried.arc.clear();
    // Nothing stands in for a loop that can't be traced.
    out.lost_loops.push_back(face_->id);
  }
}

void FaceSection::append(const Vec2& begin, const Vec2& end, const std::vector<ArcPiece>& pieces, Section& out) const {
  const auto first = static_cast<std::uint32_t>(out.pieces.size());
  out.pieces.insert(out.pieces.end(), pieces.begin(), pieces.end());
  append_range(begin, end, first, out);
}

void FaceSection::append_range(Vec2 begin, Vec2 end, std::uint32_t first, Section& out) const {
  const auto last = static_cast<std::uint32_t>(out.pieces.size());
  const Vec2 from = out.pieces[first].at(0.0);
  const Vec2 to = out.pieces[last - 1].at(1.0);
  const bool leads_in = (from - begin).squaredNorm() > limits_.tolerance * limits_.tolerance;
  const bool leads_out = (to - end).squaredNorm() > limits_.tolerance * limits_.tolerance;
  if (leads_in) append_chord(begin, from, begin, from, false, out);
  if (leads_out) append_chord(to, end, to, end, false, out);
  out.arcs.push_back({face_->id, leads_in ? from : begin, leads_out ? to : end, first, last - first});
}

void FaceSection::append_chord(const Vec2& begin, const Vec2& end, const Vec2& from, const Vec2& to, bool doubtful,
                               Section& out) const {
  out.arcs.push_back({face_->id, begin, end, static_cast<std::uint32_t>(out.pieces.size()), 1, true, doubtful});
  out.pieces.push_back(straight_piece(from, to));
}

}  // namespace lamella::span
