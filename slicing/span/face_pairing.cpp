// What FaceSection does when it enters a band: which node is joined to which by the section, and the loops that touch
// no edge. Both are the same all over the band, so they are found where nodes lie well apart: on the layer itself if it
// isn't near the band's ends, else in the middle.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "model/evaluate.h"
#include "slicing/span/face_section.h"

namespace lamella::span {

void FaceSection::enter_band(std::size_t band, double layer_z, NodeTable& nodes) {
  band_ = band;
  const double z = pairing_height(band, layer_z);
  if (face_->kind != SectionKind::traced) families_.clear();
  starts_.clear();
  ends_.clear();
  for (std::uint32_t i = 0; i < face_->uses.size(); ++i) {
    const PieceUse& use = face_->uses[i];
    if (!edges_->all()[use.piece].range.crosses(z)) continue;
    (use.ends_arc ? ends_ : starts_).push_back(i);
  }
  switch (face_->kind) {
    case SectionKind::plane:
      pair_plane(z, nodes);
      break;
    case SectionKind::round:
      pair_round(z, nodes);
      break;
    case SectionKind::traced:
      is_paired_.assign(face_->uses.size(), 0);
      carry_families(layer_z, nodes);
      pair_traced(z, z == inner_height(layer_z), nodes);
      break;
  }
}

double FaceSection::pairing_height(std::size_t band, double layer_z) const {
  const double low = face_->events[band];
  const double high = face_->events[band + 1];
  // Well inside the band the layer's own height does as well, and what is traced there is the layer's section.
  constexpr double kMargin = 0.1;
  if (layer_z > low + kMargin * (high - low) && layer_z < high - kMargin * (high - low)) return inner_height(layer_z);
  const double middle = 0.5 * (low + high);
  // Between neighbouring doubles the middle may round to the upper one, which the band doesn't hold.
  return middle < high ? middle : low;
}

void FaceSection::pair_plane(double z, const NodeTable& nodes) {
  const auto& plane = std::get<Plane>(face_->surface.surface());
  const Vec3 normal = face_->sign * plane.frame.x.cross(plane.frame.y);
  // Along z x n. A horizontal plane is only met within the tolerance of its vertices: any order will do.
  const Vec2 along = normal.head<2>().norm() < 1e-9 ? Vec2(Vec2::UnitX()) : Vec2(-normal.y(), normal.x());
  const auto sort = [&](std::vector<std::uint32_t>& uses) {
    std::vector<std::pair<double, std::uint32_t>> keyed;
    for (const std::uint32_t use : uses) {
      keyed.emplace_back(along.dot(nodes.node_at(face_->uses[use].piece, z).xy), use);
    }
    std::sort(keyed.begin(), keyed.end());
    for (std::size_t i = 0; i < uses.size(); ++i) uses[i] = keyed[i].second;
  };
  sort(starts_);
  sort(ends_);
  for (std::size_t i = 0; i < std::min(starts_.size(), ends_.size()); ++i) {
    Family family;
    family.begin = starts_[i];
    family.end = ends_[i];
    families_.push_back(family);
  }
}

void FaceSection::pair_round(double z, const NodeTable& nodes) {
  struct Candidate {
    double sweep;
    double offset;  ///< whole turns that the sweep holds beyond the difference of the charts
    std::uint32_t begin;
    std::uint32_t end;
  };
  const bool is_sphere = std::holds_alternative<Sphere>(face_->surface.surface());
  std::vector<Candidate> candidates;
  for (const std::uint32_t begin : starts_) {
    const Node from = nodes.node_at(face_->uses[begin].piece, z);
    const bool inner = is_inner(face_->uses[begin], from);
    for (const std::uint32_t end : ends_) {
      const Node to = nodes.node_at(face_->uses[end].piece, z);
      if (is_inner(face_->uses[end], to) != inner) continue;
      Family family = round_family(z, inner);
      family.begin = begin;
      family.end = end;
      const double raw = sweep_between(family, z, from, to);
      // An arc that ends where it begins has gone all the way round: the twins of a seam.
      double sweep = raw - kTwoPi * std::floor(raw / kTwoPi);
      if (sweep < 1e-12) sweep = kTwoPi;
      // A seam's two pcurves may lie a tolerance off a period apart.
      const bool is_twin = face_->uses[begin].piece == face_->uses[end].piece;
      if (is_twin) sweep = raw - kTwoPi * std::round((raw - kTwoPi) / kTwoPi);
      candidates.push_back({sweep, sweep - raw, begin, end});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.sweep, a.begin, a.end) < std::tie(b.sweep, b.begin, b.end);
  });
  is_paired_.assign(face_->uses.size(), 0);
  for (const Candidate& candidate : candidates) {
    if (is_paired_[candidate.begin] != 0 || is_paired_[candidate.end] != 0) continue;
    is_paired_[candidate.begin] = is_paired_[candidate.end] = 1;
    const PieceUse& use = face_->uses[candidate.begin];
    Family family = round_family(z, is_inner(use, nodes.node_at(use.piece, z)));
    family.begin = candidate.begin;
    family.end = candidate.end;
    family.sweep = is_sphere ? candidate.sweep : kTwoPi * std::round(candidate.offset / kTwoPi);
    families_.push_back(family);
  }
  if (!starts_.empty() || !face_->region) return;
  const bool is_torus = std::holds_alternative<Torus>(face_->surface.surface());
  for (const bool inner : {false, true}) {
    if ((inner && !is_torus) || !is_whole_ellipse(z, inner)) continue;
    families_.push_back(round_family(z, inner));
    families_.back().cut = 0;
  }
}

FaceSection::Family FaceSection::round_family(double z, bool inner) const {
  Family family;
  family.inner = inner;
  family.z = z;
  family.turn = run_of(z, inner);
  return family;
}

double FaceSection::run_of(double z, bool inner) const {
  const Surface& surface = face_->surface.surface();
  const PlaneEllipse ellipse = round_section(surface, z, inner);
  const Vec2 uv = round_parameters(surface, z, inner, 0.0);
  const Vec3 normal = face_->sign * evaluate(surface, uv).normal();
  // z x n against the way that the angle runs at 0.
  return Vec2(-normal.y(), normal.x()).dot(ellipse.sine) < 0.0 ? -1.0 : 1.0;
}

bool FaceSection::is_inner(const PieceUse& use, const Node& node) const {
  return std::holds_alternative<Torus>(face_->surface.surface()) && std::cos(chart_point(use, node)[1]) < 0.0;
}

bool FaceSection::is_whole_ellipse(double z, bool inner) const {
  const PlaneEllipse ellipse = round_section(face_->surface.surface(), z, inner);
  if (!(ellipse.cosine.norm() > 0.0)) return false;
  return face_->region->classify(round_parameters(face_->surface.surface(), z, inner, 0.0)) == TrimRegion::Side::inside;
}

void FaceSection::carry_families(double z, NodeTable& nodes) {
  // An arc that can be carried over the event, every piece measured, is the same arc on the other side of it.
  const double inner = inner_height(z);
  std::vector<Family> kept;
  for (Family& family : families_) {
    CarriedArc& carried = family.carried;
    if (carried.empty()) continue;
    bool holds = family.sheet.covers(inner) || carried.z == inner;
    if (family.cut >= 0) {
      const MonotonePiece& piece = face_->cuts[static_cast<std::size_t>(family.cut)].pieces[family.cut_piece];
      if (!piece.crosses(inner)) continue;
      const FacePoint seed = holds ? FacePoint{} : cut_point(family, inner);
      holds = holds || (seed.usable && carry(face_->surface, face_->sign, seed.point, seed.point, inner, limits_, false,
                                             work_, carried));
    } else {
      const bool is_there = std::binary_search(starts_.begin(), starts_.end(), family.begin) &&
                            std::binary_search(ends_.begin(), ends_.end(), family.end);
      if (!is_there) continue;
      if (!holds) {
        const FacePoint begin = layer_point(family.begin, z, inner, nodes);
        const FacePoint end = layer_point(family.end, z, inner, nodes);
        holds = begin.usable && end.usable &&
                carry(face_->surface, face_->sign, begin.point, end.point, inner, limits_, false, work_, carried);
      }
      if (holds) is_paired_[family.begin] = is_paired_[family.end] = 1;
    }
    if (holds) kept.push_back(std::move(family));
  }
  families_ = std::move(kept);
  drop_pierced_families(inner, nodes);
}

void FaceSection::drop_pierced_families(double inner, NodeTable& nodes) {
  // A border that begins at the event may cut through an arc that goes on analytically, and at a pass arcs part and
  // join anew while their pieces may still fit.
  std::vector<Vec2> places;
  for (const auto* uses : {&starts_, &ends_}) {
    for (const std::uint32_t use : *uses) {
      if (is_paired_[use] == 0) places.push_back(nodes.node_at(face_->uses[use].piece, inner).xy);
    }
  }
  for (const Pass& pass : face_->passes) {
    if (pass.z >= last_z_ && pass.z <= heights_[layer_]) places.push_back(pass.xy);
  }
  std::erase_if(families_, [&](const Family& family) {
    if (places.empty()) return false;
    pieces_of(family, inner);
    const auto is_pierced = [&](const Vec2& place) { return passes_near(pieces_, place); };
    if (std::none_of(places.begin(), places.end(), is_pierced)) return false;
    if (family.cut < 0) is_paired_[family.begin] = is_paired_[family.end] = 0;
    return true;
  });
}

void FaceSection::pieces_of(const Family& family, double inner) {
  pieces_ = family.carried.arc.pieces;
  if (!family.sheet.covers(inner)) return;
  pieces_.resize(family.sheet.piece_count());
  family.sheet.evaluate(inner, pieces_.data());
}

bool FaceSection::passes_near(const std::vector<ArcPiece>& pieces, const Vec2& xy) {
  for (const ArcPiece& piece : pieces) {
    const Vec2 from = piece.at(0.0);
    const Vec2 chord = piece.at(1.0) - from;
    const double square = chord.squaredNorm();
    const double along = std::clamp(chord.dot(xy - from) / square, 0.0, 1.0);
    // An arc that turns by less than 0.7 stays within a fifth of its chord from it; near is enough to look again.
    if ((xy - from - along * chord).squaredNorm() <= 0.04 * square) return true;
  }
  return false;
}

void FaceSection::pair_traced(double z, bool is_layer, const NodeTable& nodes) {
  points_.resize(face_->uses.size());
  for (const auto* uses : {&starts_, &ends_}) {
    for (const std::uint32_t use : *uses) {
      if (is_paired_[use] == 0)
        points_[use] = face_point(face_->uses[use], nodes.node_at(face_->uses[use].piece, z), z);
    }
  }
  pair_neighbors();
  trace_starts(z, is_layer);
  pair_rest();
}

void FaceSection::join(std::uint32_t begin, std::uint32_t end) {
  Family family;
  family.begin = begin;
  family.end = end;
  families_.push_back(family);
  is_paired_[begin] = is_paired_[end] = 1;
}

void FaceSection::pair_neighbors() {
  std::vector<SectionPoint> ends;
  for (const std::uint32_t end : ends_) {
    if (is_paired_[end] == 0 && points_[end].usable) ends.push_back(points_[end].point);
  }
  std::vector<std::uint32_t> crossing = starts_;
  crossing.insert(crossing.end(), ends_.begin(), ends_.end());
  std::sort(crossing.begin(), crossing.end());
  for (std::size_t first = 0; first < crossing.size();) {
    std::size_t last = first + 1;
    while (last < crossing.size() && face_->uses[crossing[last]].loop == face_->uses[crossing[first]].loop) ++last;
    for (std::size_t i = first; i < last; ++i) {
      std::uint32_t a = crossing[i];
      std::uint32_t b = crossing[i + 1 < last ? i + 1 : first];
      if (is_paired_[a] != 0 || is_paired_[b] != 0) continue;
      if (face_->uses[a].ends_arc == face_->uses[b].ends_arc) continue;
      if (face_->uses[a].ends_arc) std::swap(a, b);
      if (points_[a].usable && points_[b].usable && are_joined(points_[a], points_[b], ends)) join(a, b);
    }
    first = last;
  }
}

void FaceSection::trace_starts(double z, bool is_layer) {
  for (const std::uint32_t start : starts_) {
    if (is_paired_[start] != 0 || !points_[start].usable) continue;
    std::vector<SectionPoint> targets;
    std::vector<std::uint32_t> ids;
    std::size_t twin = kNoTwin;
    for (const std::uint32_t end : ends_) {
      if (is_paired_[end] != 0 || !points_[end].usable) continue;
      if (face_->uses[end].piece == face_->uses[start].piece) twin = targets.size();
      targets.push_back(points_[end].point);
      ids.push_back(end);
    }
    if (!trace(face_->surface, face_->sign, points_[start].point, targets, limits_, traced_, twin)) continue;
    join(start, ids[traced_.target]);
    if (!is_layer) continue;
    CarriedArc& carried = families_.back().carried;
    std::swap(carried.arc, traced_);
    carried.start(z);
  }
}

void FaceSection::pair_rest() {
  for (const std::uint32_t start : starts_) {
    if (is_paired_[start] != 0) continue;
    std::uint32_t best = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t end : ends_) {
      const double distance = (points_[end].node - points_[start].node).norm();
      if (is_paired_[end] != 0 || !(distance < nearest)) continue;
      nearest = distance;
      best = end;
    }
    if (std::isfinite(nearest)) join(start, best);
  }
}

void FaceSection::find_roots(double z) {
  roots_.clear();
  for (std::uint32_t cut = 0; cut < face_->cuts.size(); ++cut) {
    const CutLine& line = face_->cuts[cut];
    for (std::uint32_t piece = 0; piece < line.pieces.size(); ++piece) {
      if (!line.pieces[piece].crosses(z)) continue;
      const Crossing crossing = find_crossing(line.curve, line.pieces[piece], z, std::nan(""));
      roots_.push_back({cut, piece, crossing.t, crossing.at.point.head<2>(), crossing.at.dt.head<2>(), false});
    }
  }
  roots_by_x_.resize(roots_.size());
  std::iota(roots_by_x_.begin(), roots_by_x_.end(), 0U);
  std::sort(roots_by_x_.begin(), roots_by_x_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return roots_[a].xy.x() < roots_[b].xy.x(); });
}

void FaceSection::visit_roots(const Family& family, double z) {
  pieces_of(family, z);
  for (const ArcPiece& piece : pieces_) {
    const Vec2 from = piece.at(0.0);
    const Vec2 chord = piece.at(1.0) - from;
    // An arc that turns by less than 0.7 stays within a fifth of its chord from it.
    const double reach = 0.2 * chord.norm() + limits_.landing;
    const auto lies_before = [&](std::uint32_t root, double x) { return roots_[root].xy.x() < x; };
    auto next = std::lower_bound(roots_by_x_.begin(), roots_by_x_.end(), from.x() + std::min(chord.x(), 0.0) - reach,
                                 lies_before);
    const double last = from.x() + std::max(chord.x(), 0.0) + reach;
    for (; next != roots_by_x_.end() && roots_[*next].xy.x() <= last; ++next) {
      CutRoot& root = roots_[*next];
      if (!root.visited) root.visited = passes_through(piece, from, chord, root);
    }
  }
}

std::optional<double> FaceSection::nearest_place(const ArcPiece& piece, const Vec2& from, const Vec2& chord,
                                                 const Vec2& xy, double slack) {
  const double square = chord.squaredNorm();
  double t = std::clamp(chord.dot(xy - from) / square, 0.0, 1.0);
  // An arc that turns by less than 0.7 stays within a fifth of its chord from it.
  if ((xy - from - t * chord).squaredNorm() > 0.04 * square + slack * slack) return std::nullopt;
  constexpr int kSteps = 5;
  for (int i = 0; i < kSteps; ++i) {
    const Vec2 slope = piece.slope(t);
    t = std::clamp(t + slope.dot(xy - piece.at(t)) / slope.squaredNorm(), 0.0, 1.0);
  }
  if (!((xy - piece.at(t)).squaredNorm() <= slack * slack)) return std::nullopt;
  return t;
}

bool FaceSection::passes_through(const ArcPiece& piece, const Vec2& from, const Vec2& chord,
                                 const CutRoot& root) const {
  const auto t = nearest_place(piece, from, chord, root.xy, limits_.landing);
  return t && crosses_as(root, piece.slope(*t));
}

bool FaceSection::is_near_arc(const Vec2& xy, double z) {
  double slack = std::max(face_->tolerance, limits_.landing);
  for (const PieceUse& use : face_->uses) {
    slack = std::max(slack, scene_->edges[scene_->half_edges[use.half_edge].edge].tolerance);
  }
  return std::any_of(families_.begin(), families_.end(), [&](const Family& family) {
    pieces_of(family, z);
    return std::any_of(pieces_.begin(), pieces_.end(), [&](const ArcPiece& piece) {
      const Vec2 from = piece.at(0.0);
      return nearest_place(piece, from, piece.at(1.0) - from, xy, 2.0 * slack).has_value();
    });
  });
}

bool FaceSection::crosses_as(const CutRoot& root, const Vec2& slope) const {
  const CutLine& line = face_->cuts[root.cut];
  const Vec2 uv(root.u, line.v);
  const SurfacePoint at = face_->surface.evaluate_slopes(uv, face_->surface.find_cell(uv, Vec2::Zero()));
  // In the plane S_u x (z x n) = -S_u.z n.z, n the outward normal.
  const double expected = face_->sign * at.normal().z() * (line.pieces[root.piece].rises() ? -1.0 : 1.0);
  const double side = root.along.x() * slope.y() - root.along.y() * slope.x();
  // On an upright face the section runs along the cut as seen from above, and says nothing.
  constexpr double kParallel = 1e-6;
  return !(side * expected < 0.0 && std::abs(side) > kParallel * root.along.norm() * slope.norm());
}

void FaceSection::find_loops(double z, Section& out) {
  find_roots(z);
  if (roots_.empty()) return;
  for (const Family& family : families_) {
    if (!family.carried.empty()) visit_roots(family, z);
  }
  for (std::size_t i = 0; i < roots_.size(); ++i) {
    if (roots_[i].visited) continue;
    const CutLine& line = face_->cuts[roots_[i].cut];
    const Vec2 slack = 1e-9 * face_->region->bounds().sizes();
    const TrimRegion::Side side = face_->region->classify(Vec2(roots_[i].u, line.v), slack);
    if (side == TrimRegion::Side::outside) continue;
    Family family;
    family.cut = static_cast<std::int32_t>(roots_[i].cut);
    family.cut_piece = roots_[i].piece;
    const FacePoint seed = cut_point(family, z);
    roots_[i].visited = true;
    end_points_.front() = seed.point;
    if (!seed.usable || !trace(face_->surface, face_->sign, seed.point, end_points_, limits_, family.carried.arc)) {
      // On the border it is more likely that a node was missed by its tolerance than that there is a loop.
      if (side == TrimRegion::Side::inside) out.lost_loops.push_back(face_->id);
      continue;
    }
    // What runs into an end node is an arc that has been found already. If that one was followed, and not through here
    // within the tolerance of the face's edges, one of the two is wrong.
    if (const std::size_t target = family.carried.arc.target; target != 0) {
      const bool is_inside = side == TrimRegion::Side::inside;
      if (is_inside && is_known_[target] != 0 && !is_near_arc(seed.point.xy, z)) out.lost_loops.push_back(face_->id);
      continue;
    }
    family.carried.start(z);
    visit_roots(family, z);
    families_.push_back(std::move(family));
  }
}

}  // namespace lamella::span
