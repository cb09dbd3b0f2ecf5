#include "slicing/adaptive/face_slants.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <tuple>
#include <utility>

#include "model/bounds.h"
#include "model/de_casteljau.h"
#include "model/evaluate.h"

namespace lamella {

namespace {

constexpr std::size_t kMaxCells = 50000;
constexpr int kMaxDepth = 40;
/// Of the face's height: parts at its border are no higher than the larger of this and what is asked for.
constexpr double kBorderPart = 1.0 / 512.0;
constexpr std::size_t kMaxSlantNet = 200;  // vectors
/// mm. Slants that tilt a layer of a metre by less are none.
constexpr double kNoSlant = 1e-9;
/// Of a parameter's size: parameters are padded by it, as rounding of pcurves may lead out of the face's bounds.
constexpr double kPadding = 1e-9;

/// A part of a patch: heights as (w z, w) and slants.
struct Cell {
  int degree_u = 0;
  int degree_v = 0;
  std::vector<Vec2> heights;
  SlantNet slants;
  bool is_inside = false;  ///< no border within
  int depth = 0;
};

Cell make_cell(const BezierPatch& patch, const NormalNet& normals) {
  Cell cell{patch.degree_u, patch.degree_v, {}, slant_net(normals)};
  cell.heights.reserve(patch.net.size());
  for (const Vec4& p : patch.net) cell.heights.emplace_back(p[2], p[3]);
  return cell;
}

Interval height_range(const Cell& cell) {
  Interval z{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Vec2& p : cell.heights) {
    z.lo = std::min(z.lo, p[0] / p[1]);
    z.hi = std::max(z.hi, p[0] / p[1]);
  }
  return z;
}

bool rises_more_in_u(const Cell& cell) {
  const int stride = cell.degree_v + 1;
  const auto height = [&](int i, int j) { return cell.heights[i * stride + j][0] / cell.heights[i * stride + j][1]; };
  double in_u = 0.0;
  double in_v = 0.0;
  for (int i = 0; i <= cell.degree_u; ++i) {
    for (int j = 0; j <= cell.degree_v; ++j) {
      if (i > 0) in_u = std::max(in_u, cell.degree_u * std::abs(height(i, j) - height(i - 1, j)));
      if (j > 0) in_v = std::max(in_v, cell.degree_v * std::abs(height(i, j) - height(i, j - 1)));
    }
  }
  return in_u >= in_v;
}

std::pair<Cell, Cell> halve(const Cell& cell, bool along_u) {
  std::pair<Cell, Cell> out{cell, cell};
  std::tie(out.first.slants, out.second.slants) = halves(cell.slants, along_u);
  const int stride = cell.degree_v + 1;
  if (along_u) {
    for (int j = 0; j < stride; ++j) {
      split_in_place(out.first.heights.data() + j, out.second.heights.data() + j, cell.degree_u, stride, 0.5);
    }
  } else {
    for (int i = 0; i <= cell.degree_u; ++i) {
      split_in_place(out.first.heights.data() + i * stride, out.second.heights.data() + i * stride, cell.degree_v, 1,
                     0.5);
    }
  }
  out.first.depth = out.second.depth = cell.depth + 1;
  return out;
}

Box2 padded(Box2 box) {
  const Vec2 size = box.sizes() + box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
  box.min() -= kPadding * size;
  box.max() += kPadding * size;
  return box;
}

/// Without the patches that are padding only: beyond a knot the surface may have a crease, and another normal, which
/// isn't the face's.
RationalForm without_padding(RationalForm form, const Box2& uv) {
  const auto is_padding = [](RationalForm::Map map, const Interval& own, double lo, double hi) {
    const double padding = 2.0 * kPadding * (hi - lo + std::max(std::abs(lo), std::abs(hi)));
    return map == RationalForm::Map::same && own.length() <= padding &&
           (own.hi <= lo + padding || own.lo >= hi - padding);
  };
  std::vector<BezierPatch> kept;
  for (const BezierPatch& patch : form.patches) {
    if (is_padding(form.map_u, patch.u, uv.min().x(), uv.max().x())) continue;
    if (is_padding(form.map_v, patch.v, uv.min().y(), uv.max().y())) continue;
    kept.push_back(patch);
  }
  if (!kept.empty()) form.patches = std::move(kept);
  return form;
}

Interval clipped(const Interval& z, const Interval& to) {
  return {std::clamp(z.lo, to.lo, to.hi), std::clamp(z.hi, to.lo, to.hi)};
}

}  // namespace

FaceSlants::FaceSlants(const Scene& scene, FaceId face)
    : face_(scene.faces[face]),
      region_(scene, face),
      form_(without_padding(rational_form(face_.surface, padded(face_.uv_bounds)), face_.uv_bounds)) {
  nets_.reserve(form_.patches.size());
  for (const BezierPatch& patch : form_.patches) nets_.push_back(normal_net(patch));
  box_ = face_bounds(scene, face).box;
  if (!box_.isEmpty()) heights_ = heights_of(box_);
}

Vec3 FaceSlants::normal_at(const Vec2& uv) const {
  const SurfacePoint at = evaluate(face_.surface, uv);
  const Vec3 normal = at.normal();
  // Where a derivative vanishes (a pole, an apex) the product is rounding.
  const double length = normal.norm();
  if (!(length > 1e-12 * (at.du.squaredNorm() + at.dv.squaredNorm()))) return Vec3::Zero();
  return (face_.same_sense ? 1.0 : -1.0) / length * normal;
}

Vec3 FaceSlants::normal_beside(const Vec2& uv) const { return normal_at(uv + 1e-3 * (face_.uv_bounds.center() - uv)); }

NormalCone FaceSlants::normals(const Box2& uv) const {
  if (nets_.empty()) return {};
  const Vec2 from = form_.from_surface(uv.min());
  const Vec2 to = form_.from_surface(uv.max());
  std::vector<Vec3> vectors;
  double rounding = 0.0;
  Interval u = nets_.front().u;
  Interval v = nets_.front().v;
  for (const NormalNet& net : nets_) {
    u = {std::min(u.lo, net.u.lo), std::max(u.hi, net.u.hi)};
    v = {std::min(v.lo, net.v.lo), std::max(v.hi, net.v.hi)};
  }
  // Parameters of edges are rounded, and may lie a little beyond the surface.
  const Vec2 lo(std::clamp(from.x(), u.lo, u.hi), std::clamp(from.y(), v.lo, v.hi));
  const Vec2 hi(std::clamp(to.x(), u.lo, u.hi), std::clamp(to.y(), v.lo, v.hi));
  for (const NormalNet& net : nets_) {
    if (net.u.hi < lo.x() || net.u.lo > hi.x() || net.v.hi < lo.y() || net.v.lo > hi.y()) continue;
    const NormalNet part = restrict_to(net, {lo.x(), hi.x()}, {lo.y(), hi.y()});
    for (const Vec3& d : part.net) vectors.push_back(face_.same_sense ? d : Vec3(-d));
    rounding = std::max(rounding, net.rounding);
  }
  return cone_of(vectors, rounding);
}

NormalCone FaceSlants::normals_of(std::size_t patch, const Interval& u, const Interval& v) const {
  NormalNet part = restrict_to(nets_[patch], u, v);
  if (!face_.same_sense) {
    for (Vec3& d : part.net) d = -d;
  }
  return cone_of(part);
}

double FaceSlants::largest_slant_of(std::size_t patch, const Interval& u, const Interval& v) const {
  const NormalNet part = restrict_to(nets_[patch], u, v);
  // The work grows with the square of the net: of large ones the cone has to do, which is as good where parts are
  // small.
  if (part.net.size() > kMaxSlantNet) return largest_slant(cone_of(part));
  return slant_range(slant_net(part)).bound;
}

LookRange FaceSlants::looks_of(std::size_t patch, const Interval& u, const Interval& v) const {
  const NormalNet part = restrict_to(nets_[patch], u, v);
  const double sense = face_.same_sense ? 1.0 : -1.0;
  LookRange out;
  out.slant = largest_slant(cone_of(part));
  for (const Vec3& d : part.net) {
    out.up |= sense * d.z() > part.rounding;
    out.down |= sense * d.z() < -part.rounding;
  }
  return out;
}

bool FaceSlants::is_outside(const Interval& u, const Interval& v) const {
  const Vec2 lo = form_.to_surface({u.lo, v.lo});
  const Vec2 hi = form_.to_surface({u.hi, v.hi});
  return region_.classify(0.5 * (lo + hi), 0.5 * (hi - lo)) == TrimRegion::Side::outside;
}

std::vector<Slant> FaceSlants::parts(double resolution) const {
  if (const Plane* plane = std::get_if<Plane>(&face_.surface)) {
    return {{heights_, std::min(1.0, std::abs(plane->frame.z.normalized().z()))}};
  }
  const double border_part = std::max(resolution, kBorderPart * heights_.length());
  std::vector<Slant> out;
  std::deque<Cell> open;  // all of a size before their halves, so that too much work leaves all coarse alike
  std::size_t cells = 0;
  for (std::size_t p = 0; p < nets_.size(); ++p) open.push_back(make_cell(form_.patches[p], nets_[p]));
  while (!open.empty()) {
    Cell cell = std::move(open.front());
    open.pop_front();
    ++cells;
    if (!cell.is_inside) {
      const Vec2 lo = form_.to_surface({cell.slants.u.lo, cell.slants.v.lo});
      const Vec2 hi = form_.to_surface({cell.slants.u.hi, cell.slants.v.hi});
      const auto side = region_.classify(0.5 * (lo + hi), 0.5 * (hi - lo));
      if (side == TrimRegion::Side::outside) continue;
      cell.is_inside = side == TrimRegion::Side::inside;
    }
    const Interval z = height_range(cell);
    const SlantRange slant = slant_range(cell.slants);
    if (slant.bound <= kNoSlant) continue;
    const bool is_bounded = slant.bound <= slant.most_corner + kSlantAccuracy;
    const bool is_even = is_bounded && slant.bound <= slant.least_corner + kSlantAccuracy;
    const bool is_low = z.length() <= (cell.is_inside ? resolution : border_part);
    const bool is_done = is_bounded && (is_low || (cell.is_inside && is_even));
    if (is_done || cell.depth >= kMaxDepth || cells + open.size() > kMaxCells) {
      out.push_back({clipped(z, heights_), slant.bound});
      continue;
    }
    auto [first, second] = halve(cell, is_even ? rises_more_in_u(cell) : changes_more_in_u(cell.slants));
    open.push_back(std::move(first));
    open.push_back(std::move(second));
  }
  return out;
}

}  // namespace lamella
