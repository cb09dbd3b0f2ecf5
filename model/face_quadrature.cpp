#include "model/face_quadrature.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "model/bernstein_roots.h"
#include "model/de_casteljau.h"
#include "model/evaluate.h"
#include "model/iso_line.h"
#include "model/quadrature.h"
#include "model/trim.h"

namespace lamella {

namespace {

constexpr double kQuarterTurn = 0.5 * kPi;
constexpr std::size_t kMaxStrips = 1'000'000;
constexpr int kAnalyticNodes = 10;
/// Of the largest parameter: what a border's point along a knot line is off it.
constexpr double kRounding = 1e-15;

using Sums5 = Eigen::Array<double, 5, 1>;
using Sums1 = Eigen::Array<double, 1, 1>;

/// The knots within (lo, hi), each once.
std::vector<double> inner_knots(const std::vector<double>& knots, double lo, double hi) {
  std::vector<double> inner;
  for (const double knot : knots) {
    if (knot > lo && knot < hi && (inner.empty() || knot > inner.back())) inner.push_back(knot);
  }
  return inner;
}

const std::vector<double>* knots_of(const Curve3& curve) {
  const auto* spline = std::get_if<BSplineCurve<3>>(&curve);
  return spline == nullptr ? nullptr : &spline->knots;
}

/// Longest panel for a curve's parameter where it is an angle or grows exponentially, else 0.
double step_of(const Curve3& curve) {
  if (std::holds_alternative<Ellipse<3>>(curve)) return kQuarterTurn;
  return std::holds_alternative<Hyperbola<3>>(curve) ? 1.0 : 0.0;
}

/// Nodes that integrate a polynomial surface's flux exactly: degree 3 p - 1 in each parameter. At least 8, for areas
/// and rational surfaces.
int spline_nodes(int degree) { return std::max(8, (3 * degree + 1) / 2); }

int nodes_of(const Curve3& curve) {
  const auto* spline = std::get_if<BSplineCurve<3>>(&curve);
  return std::max(kAnalyticNodes, spline == nullptr ? 0 : spline_nodes(spline->degree));
}

int panel_count(double length, double step) {
  if (!(step > 0.0) || !std::isfinite(length)) return 1;
  return static_cast<int>(std::clamp(std::ceil(length / step - 1e-9), 1.0, 256.0));
}

struct MeasureIntegrand {
  Vec3 reference;

  Sums5 operator()(const SurfacePoint& at) const {
    const Vec3 n = at.normal();
    Sums5 sums;
    sums << (at.point - reference).dot(n) / 3.0, n.norm(), n.cwiseAbs().array();
    return sums;
  }
};

struct SolidAngleIntegrand {
  Vec3 eye;

  Sums1 operator()(const SurfacePoint& at) const {
    const Vec3 way = at.point - eye;
    const double distance = way.norm();
    return Sums1(way.dot(at.normal()) / (distance * distance * distance));
  }
};

/// Levels below 1 take fewer nodes, level 1 all of them, each further level halves the panels.
int nodes_at(int level, int nodes) { return level > 0 ? nodes : ((level == 0 ? 3 : 2) * nodes + 4) / 5; }
int parts_at(int level) { return level > 1 ? 1 << (level - 1) : 1; }

/// H(u, v) = integral of F(u, s) ds from the first panel's start to v.
template <class Sums, class Line, class Integrand>
class InnerIntegral {
 public:
  InnerIntegral(Line& line, const Integrand& integrand, const std::vector<double>& panels, int level, int nodes)
      : line_(line),
        integrand_(integrand),
        panels_(panels),
        parts_(parts_at(level)),
        rounding_(kRounding * std::max(std::abs(panels.front()), std::abs(panels.back()))),
        rule_(gauss_legendre(nodes_at(level, nodes))) {
    std::vector<double> places;
    for (std::size_t p = 0; p + 1 < panels.size(); ++p) {
      visit(panels[p], panels[p + 1], [&](double v, double) { places.push_back(v); });
    }
    line_.set_nodes(std::move(places));
  }

  void set_u(double u) { line_.set_u(u); }

  [[nodiscard]] Sums operator()(double v) const {
    const auto end = std::upper_bound(panels_.begin(), panels_.end(), v + rounding_);
    const std::size_t whole = end == panels_.begin() ? 0 : static_cast<std::size_t>(end - panels_.begin()) - 1;
    Sums sums = Sums::Zero();
    std::size_t node = 0;
    for (std::size_t p = 0; p < whole; ++p) {
      visit(panels_[p], panels_[p + 1],
            [&](double, double weight) { sums += weight * integrand_(line_.at_node(node++)); });
    }
    if (std::abs(v - panels_[whole]) > rounding_) {
      visit(panels_[whole], v, [&](double s, double weight) { sums += weight * integrand_(line_.at(s)); });
    }
    return sums;
  }

 private:
  /// Calls `use(place, weight)` for every node between lo and hi.
  template <class Use>
  void visit(double lo, double hi, const Use& use) const {
    const double width = (hi - lo) / parts_;
    for (int part = 0; part < parts_; ++part) {
      for (std::size_t k = 0; k < rule_.nodes.size(); ++k) {
        use(lo + (part + rule_.nodes[k]) * width, rule_.weights[k] * width);
      }
    }
  }

  Line& line_;
  const Integrand& integrand_;
  const std::vector<double>& panels_;
  int parts_;
  double rounding_;  ///< of v: a border along a panel's end lies on it up to this
  const GaussRule& rule_;
};

struct BorderPoint {
  Vec2 uv;
  double du;  ///< by the piece's parameter in [0, 1]
};

BorderPoint border_point(const BezierCurve2& piece, double s) {
  const auto [value, slope] = evaluate_bezier(piece.net.data(), static_cast<int>(piece.net.size()) - 1, 1, s);
  const Vec2 uv = value.head<2>() / value[2];
  return {uv, (slope[0] - slope[2] * uv[0]) / value[2]};
}

Box2 piece_box(const BezierCurve2& piece) {
  Box2 box;
  for (const Vec3& p : piece.net) box.extend(Vec2(p.head<2>() / p[2]));
  return box;
}

}  // namespace

bool FaceIntegrals::is_finite() const {
  return std::isfinite(flux) && std::isfinite(area) && abs_normal_area.allFinite();
}

FaceQuadrature::FaceQuadrature(const Scene& scene, FaceId face) : face_(scene.faces[face]) {
  const TrimRegion region(scene, face);
  border_ = region.boundary();
  for (const BezierCurve2& piece : border_) bounds_.extend(piece_box(piece));
  if (border_.empty() || !bounds_.min().allFinite() || !bounds_.max().allFinite()) {
    border_.clear();
    bounds_ = Box2(Vec2::Zero(), Vec2::Zero());
  }
  set_nodes();
  set_panels();
  split_border();
}

void FaceQuadrature::set_spline(const BSplineSurface& surface) {
  set_knots(0, &surface.knots_u);
  set_knots(1, &surface.knots_v);
  inner_nodes_ = spline_nodes(surface.degree_v);
  outer_nodes_ = std::max(spline_nodes(surface.degree_u), kAnalyticNodes);
}

void FaceQuadrature::set_knots(int axis, const std::vector<double>* knots) {
  if (knots == nullptr) return;
  (axis == 0 ? knots_u_ : knots_v_) = inner_knots(*knots, bounds_.min()[axis], bounds_.max()[axis]);
}

void FaceQuadrature::set_nodes() {
  inner_nodes_ = outer_nodes_ = kAnalyticNodes;
  std::visit(
      [&](const auto& s) {
        using T = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<T, Plane>) {
          inner_nodes_ = 1;  // everything is constant
        } else if constexpr (std::is_same_v<T, Cylinder> || std::is_same_v<T, Cone>) {
          step_.x() = kQuarterTurn;
          inner_nodes_ = 2;  // at most quadratic in v
        } else if constexpr (std::is_same_v<T, Sphere> || std::is_same_v<T, Torus>) {
          step_ = Vec2::Constant(kQuarterTurn);
        } else if constexpr (std::is_same_v<T, Extrusion>) {
          set_knots(0, knots_of(s.basis));
          step_.x() = step_of(s.basis);
          inner_nodes_ = 2;
          outer_nodes_ = nodes_of(s.basis);
        } else if constexpr (std::is_same_v<T, Revolution>) {
          set_knots(1, knots_of(s.meridian));
          step_ = Vec2(kQuarterTurn, step_of(s.meridian));
          inner_nodes_ = nodes_of(s.meridian);
        } else if constexpr (std::is_same_v<T, BSplineSurface>) {
          set_spline(s);
        } else {
          set_spline(s.fit);
        }
      },
      face_.surface);
}

void FaceQuadrature::set_panels() {
  panels_v_ = {bounds_.min().y()};
  panels_v_.insert(panels_v_.end(), knots_v_.begin(), knots_v_.end());
  const double length = bounds_.sizes().y();
  const int count = panel_count(length, step_.y());
  for (int i = 1; i < count; ++i) panels_v_.push_back(bounds_.min().y() + length * i / count);
  panels_v_.push_back(bounds_.max().y());
  std::sort(panels_v_.begin(), panels_v_.end());
}

std::vector<double> FaceQuadrature::crossings(const BezierCurve2& piece) const {
  const Box2 box = piece_box(piece);
  std::vector<double> cuts;
  std::vector<double> coefficients(piece.net.size());
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<double>& knots = axis == 0 ? knots_u_ : knots_v_;
    const auto first = std::upper_bound(knots.begin(), knots.end(), box.min()[axis]);
    const auto last = std::lower_bound(knots.begin(), knots.end(), box.max()[axis]);
    for (auto knot = first; knot < last; ++knot) {
      double scale = 0.0;
      for (std::size_t i = 0; i < coefficients.size(); ++i) {
        coefficients[i] = piece.net[i][axis] - *knot * piece.net[i][2];
        scale = std::max(scale, std::abs(*knot * piece.net[i][2]));
      }
      const std::vector<double> roots = bernstein_roots(coefficients, scale);
      cuts.insert(cuts.end(), roots.begin(), roots.end());
      if (cuts.size() > kMaxStrips) return cuts;
    }
  }
  const int count = std::max(panel_count(box.sizes().x(), step_.x()), panel_count(box.sizes().y(), step_.y()));
  for (int i = 1; i < count; ++i) cuts.push_back(static_cast<double>(i) / count);
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

void FaceQuadrature::add_strips(std::size_t piece, const std::vector<double>& cuts) {
  double from = 0.0;
  for (const double cut : cuts) {
    if (cut > from && cut < 1.0) {
      strips_.push_back({piece, {from, cut}});
      from = cut;
    }
  }
  strips_.push_back({piece, {from, 1.0}});
}

void FaceQuadrature::split_border() {
  for (std::size_t i = 0; i < border_.size(); ++i) {
    const Box2 box = piece_box(border_[i]);
    const bool along_v = box.min().x() == box.max().x();  // du = 0
    if (!along_v) add_strips(i, crossings(border_[i]));
    if (strips_.size() > kMaxStrips) {
      throw GeometryError("the face's border crosses too many knot lines", "#" + std::to_string(face_.step_entity),
                          "simplify the face's surface or its trimming curves");
    }
  }
}

double FaceQuadrature::parameter_area() const {
  const GaussRule& rule = gauss_legendre(kAnalyticNodes);
  const double v0 = panels_v_.front();
  double area = 0.0;
  for (const Strip& strip : strips_) {
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      const double s = strip.s.lo + rule.nodes[k] * strip.s.length();
      const BorderPoint at = border_point(border_[strip.piece], s);
      area -= rule.weights[k] * strip.s.length() * at.du * (at.uv.y() - v0);
    }
  }
  return area;
}

template <class Sums, class Inner>
Sums FaceQuadrature::integrate_border(Inner& inner, int level, int outer_nodes) const {
  const GaussRule& rule = gauss_legendre(nodes_at(level, outer_nodes));
  const int parts = parts_at(level);
  Sums sums = Sums::Zero();
  for (const Strip& strip : strips_) {
    const double width = strip.s.length() / parts;
    for (int part = 0; part < parts; ++part) {
      for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const BorderPoint at = border_point(border_[strip.piece], strip.s.lo + (part + rule.nodes[k]) * width);
        inner.set_u(at.uv.x());
        sums -= (rule.weights[k] * width * at.du) * inner(at.uv.y());
      }
    }
  }
  return sums;
}

template <class Sums, class Integrand>
Sums FaceQuadrature::integrate(QuadratureLevel level, int min_nodes, const Integrand& integrand) const {
  const int nodes = std::max(inner_nodes_, min_nodes);
  const int outer = std::max(outer_nodes_, min_nodes);
  const auto run = [&](auto line) {
    InnerIntegral<Sums, decltype(line), Integrand> inner(line, integrand, panels_v_, level.inner, nodes);
    return integrate_border<Sums>(inner, level.outer, outer);
  };
  if (const auto* spline = std::get_if<BSplineSurface>(&face_.surface)) return run(SplineLine(*spline));
  if (const auto* fitted = std::get_if<FittedSurface>(&face_.surface)) return run(SplineLine(fitted->fit));
  if (const auto* turned = std::get_if<Revolution>(&face_.surface)) return run(RevolutionLine(*turned));
  return run(AnalyticLine(face_.surface));
}

FaceIntegrals FaceQuadrature::integrate(const Vec3& reference, QuadratureLevel level) const {
  const Sums5 sums = integrate<Sums5>(level, 1, MeasureIntegrand{reference});
  return {face_.same_sense ? sums[0] : -sums[0], sums[1], Vec3(sums[2], sums[3], sums[4])};
}

double FaceQuadrature::solid_angle(const Vec3& point, QuadratureLevel level) const {
  const double angle = integrate<Sums1>(level, kAnalyticNodes, SolidAngleIntegrand{point})[0];
  return face_.same_sense ? angle : -angle;
}

double FaceQuadrature::cost(QuadratureLevel level) const {
  double cost = 0.0;
  for (const Strip& strip : strips_) {
    const double v = border_point(border_[strip.piece], strip.s.middle()).uv.y();
    const auto above = std::upper_bound(panels_v_.begin(), panels_v_.end(), v);
    cost += static_cast<double>(std::max<std::ptrdiff_t>(above - panels_v_.begin(), 1));
  }
  return cost * nodes_at(level.inner, inner_nodes_) * parts_at(level.inner) * nodes_at(level.outer, outer_nodes_) *
         parts_at(level.outer);
}

bool FaceQuadrature::has_inner_levels() const { return nodes_at(0, inner_nodes_) != inner_nodes_; }

}  // namespace lamella
