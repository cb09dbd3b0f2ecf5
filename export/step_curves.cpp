#include "export/step_curves.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lamella {

namespace {

/// Radii that differ by less are those of a circle: a few roundings of the surface's own.
constexpr double kRound = 1e-12;
/// mm: pieces of an arc meet to rounding, and their tangents are those of one point.
constexpr double kSmooth = 1e-9;
/// Of spans of knots from one to the next; more would be no smooth curve to anyone.
constexpr double kLargestRatio = 1e3;
/// Radians: what sweeps more than all but this is a whole ellipse.
constexpr double kWhole = 1e-9;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

using Bezier = std::array<Vec2, 6>;

/// The ratio of spans of knots at which the derivative goes on from a to b.
double span_ratio(const Bezier& a, const Bezier& b) { return (b[1] - b[0]).norm() / (a[5] - a[4]).norm(); }

/// Whether the pole between two stretches is the one that a curve with a continuous derivative has there.
bool is_smooth(const Bezier& a, const Bezier& b) {
  const double ratio = span_ratio(a, b);
  if (!(ratio * kLargestRatio > 1.0 && ratio < kLargestRatio)) return false;
  const Vec2 between = (ratio * a[4] + b[1]) / (1.0 + ratio);
  return (b[0] - a[5]).norm() <= kSmooth && (between - a[5]).norm() <= kSmooth;
}

/// Writes the curves of one loop.
class LoopWriter {
 public:
  LoopWriter(StepEntities& entities, double z) : entities_(entities), height_(step_exact_real(z)) {}

  StepId point(const Vec2& xy) {
    return entities_.add(
        fmt::format("CARTESIAN_POINT('',({},{},{}))", step_exact_real(xy.x()), step_exact_real(xy.y()), height_));
  }

  StepId polyline(std::span<const Vec2> corners) {
    std::vector<StepId> points;
    for (const Vec2& corner : corners) points.push_back(point(corner));
    return entities_.add("POLYLINE(''," + step_list(points) + ")");
  }

  StepId conic(const ConicArc& arc, std::string_view name) {
    const double radius = arc.major.norm();
    const double other = arc.minor.norm();
    const Vec2 along = arc.major / radius;
    const StepId center = point(arc.center);
    // The angle runs counterclockwise as seen from the tip of the axis.
    const StepId axis =
        entities_.add(cross(arc.major, arc.minor) > 0.0 ? "DIRECTION('',(0.,0.,1.))" : "DIRECTION('',(0.,0.,-1.))");
    const StepId x =
        entities_.add(fmt::format("DIRECTION('',({},{},0.))", step_exact_real(along.x()), step_exact_real(along.y())));
    const StepId placement = entities_.add(fmt::format("AXIS2_PLACEMENT_3D('',#{},#{},#{})", center, axis, x));
    if (radius - other <= kRound * radius) {
      return entities_.add(fmt::format("CIRCLE({},#{},{})", name, placement, step_exact_real(radius)));
    }
    return entities_.add(
        fmt::format("ELLIPSE({},#{},{},{})", name, placement, step_exact_real(radius), step_exact_real(other)));
  }

  StepId trimmed_conic(const ConicArc& arc) {
    const StepId basis = conic(arc, "''");
    return entities_.add(
        fmt::format("TRIMMED_CURVE('',#{},(PARAMETER_VALUE({})),(PARAMETER_VALUE({})),.T.,.PARAMETER.)", basis,
                    step_exact_real(arc.begin), step_exact_real(arc.begin + arc.sweep)));
  }

  StepId rational(const RationalBezier& bezier) {
    std::vector<StepId> poles;
    for (const Vec2& pole : bezier.poles) poles.push_back(point(pole));
    const auto& w = bezier.weights;
    return entities_.add(
        fmt::format("(BOUNDED_CURVE()B_SPLINE_CURVE(2,{},.UNSPECIFIED.,.F.,.F.)B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.),"
                    ".UNSPECIFIED.)"
                    "CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE(({},{},{}))REPRESENTATION_ITEM(''))",
                    step_list(poles), step_exact_real(w[0]), step_exact_real(w[1]), step_exact_real(w[2])));
  }

  /// Stretches that run smoothly into each other, as one curve with knots of multiplicity 4: spans of
  /// knots are in the ratio of speeds, so that its derivative goes on, and no pole lies where stretches meet. Readers
  /// of OpenCASCADE's family change a curve that has a pole there.
  StepId spline(std::span<const Bezier> beziers) {
    std::vector<StepId> poles{point(beziers.front().front())};
    std::string multiplicities = "6";
    std::string knots = "0.";
    double knot = 0.0;
    double span = 1.0;
    for (std::size_t i = 0; i < beziers.size(); ++i) {
      if (i > 0) span *= span_ratio(beziers[i - 1], beziers[i]);
      knot += span;
      const bool is_last = i + 1 == beziers.size();
      for (std::size_t k = 1; k < (is_last ? 6U : 5U); ++k) poles.push_back(point(beziers[i][k]));
      multiplicities += is_last ? ",6" : ",4";
      (knots += ",") += step_exact_real(knot);
    }
    return entities_.add(fmt::format("B_SPLINE_CURVE_WITH_KNOTS('',5,{},.UNSPECIFIED.,.F.,.F.,({}),({}),.UNSPECIFIED.)",
                                     step_list(poles), multiplicities, knots));
  }

 private:
  StepEntities& entities_;
  std::string height_;
};

}  // namespace

ConicArc conic_of(const CurveStretch& stretch) {
  const auto& n = stretch.carrier.numbers;
  const Vec2 r0(n[2], n[3]);
  const Vec2 r1(n[4], n[5]);
  ConicArc arc;
  arc.center = {n[0], n[1]};
  // The radius' square has its extremes where its derivative, (r1^2 - r0^2) sin 2a / 2 + r0 r1 cos 2a, vanishes. Radii
  // of a circle stay as they are: of them all are extreme.
  const double dot = r0.dot(r1);
  const double difference = r0.squaredNorm() - r1.squaredNorm();
  const bool is_circle = std::hypot(2.0 * dot, difference) <= kRound * (r0.squaredNorm() + r1.squaredNorm());
  double turn = is_circle ? 0.0 : 0.5 * std::atan2(2.0 * dot, difference);
  arc.major = std::cos(turn) * r0 + std::sin(turn) * r1;
  arc.minor = std::cos(turn) * r1 - std::sin(turn) * r0;
  if (arc.minor.squaredNorm() > arc.major.squaredNorm()) {
    arc.major = std::exchange(arc.minor, Vec2(-arc.major));
    turn += 0.5 * std::numbers::pi;
  }
  const double from = n[6] + stretch.begin * n[7] - turn;
  const double to = n[6] + stretch.end * n[7] - turn;
  arc.sweep = std::abs(to - from);
  arc.begin = from;
  if (to < from) {
    arc.begin = -from;
    arc.minor = -arc.minor;
  }
  arc.begin -= kTwoPi * std::floor(arc.begin / kTwoPi);
  return arc;
}

std::array<Vec2, 6> bezier_of(const CurveStretch& stretch) {
  // Blossoming: pole i is the polar form at 5 - i times `begin` and i times `end`; that of t^k is the mean of the
  // products of k of the five arguments.
  const auto& n = stretch.carrier.numbers;
  Bezier poles;
  for (std::size_t i = 0; i < 6; ++i) {
    // Elementary symmetric functions of the arguments.
    std::array<double, 6> e{1.0};
    for (std::size_t k = 0; k < 5; ++k) {
      const double argument = k < 5 - i ? stretch.begin : stretch.end;
      for (std::size_t j = k + 1; j > 0; --j) e[j] += argument * e[j - 1];
    }
    constexpr std::array kBinomial{1.0, 5.0, 10.0, 10.0, 5.0, 1.0};
    poles[i] = Vec2::Zero();
    for (std::size_t k = 0; k < 6; ++k) poles[i] += e[k] / kBinomial[k] * Vec2(n[k], n[k + 6]);
  }
  return poles;
}

RationalBezier rational_of(const CurveStretch& stretch) {
  // The blossom of the poles with their weights as a third coordinate.
  const auto& n = stretch.carrier.numbers;
  RationalBezier bezier;
  for (std::size_t i = 0; i < 3; ++i) {
    const double s = i < 2 ? stretch.begin : stretch.end;
    const double t = i < 1 ? stretch.begin : stretch.end;
    const double first = (1.0 - s) * (1.0 - t);
    const double middle = n[6] * (s * (1.0 - t) + t * (1.0 - s));
    bezier.weights[i] = first + middle + s * t;
    bezier.poles[i] =
        (first * Vec2(n[0], n[1]) + middle * Vec2(n[2], n[3]) + s * t * Vec2(n[4], n[5])) / bezier.weights[i];
  }
  return bezier;
}

StepId add_curve_loop(StepEntities& entities, std::span<const CurveStretch> loop, double z, std::string_view name) {
  LoopWriter writer(entities, z);
  if (loop.size() == 1 && loop.front().carrier.kind == CurveKind::ellipse) {
    const ConicArc arc = conic_of(loop.front());
    if (arc.sweep > kTwoPi - kWhole) return writer.conic(arc, name);
  }
  std::vector<StepId> segments;
  const auto add = [&](StepId curve) {
    segments.push_back(entities.add(fmt::format("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{})", curve)));
  };
  std::vector<Bezier> beziers;
  const auto end_curve = [&] {
    if (!beziers.empty()) add(writer.spline(beziers));
    beziers.clear();
  };
  for (const CurveStretch& stretch : loop) {
    if (!stretch.carrier.kind) {
      // One line each: OpenCASCADE would round the corners of a longer one within a composite curve.
      end_curve();
      add(writer.polyline(std::array{stretch.first(), stretch.last()}));
    } else if (*stretch.carrier.kind == CurveKind::quintic) {
      const Bezier bezier = bezier_of(stretch);
      if (beziers.empty() || !is_smooth(beziers.back(), bezier)) end_curve();
      beziers.push_back(bezier);
    } else if (*stretch.carrier.kind == CurveKind::conic) {
      end_curve();
      add(writer.rational(rational_of(stretch)));
    } else {
      end_curve();
      add(writer.trimmed_conic(conic_of(stretch)));
    }
  }
  end_curve();
  return entities.add(fmt::format("COMPOSITE_CURVE({},{},.F.)", name, step_list(segments)));
}

}  // namespace lamella
