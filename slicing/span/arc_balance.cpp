#include "slicing/span/arc_balance.h"

#include <cmath>

namespace lamella::span {

namespace {

/// Cosine between the rows and the normal, the face's or the arc's own, below which a node counts as a turning point
/// itself: there the side is not decided.
constexpr double kGrazing = 1e-4;

/// An arc at its begin or end: first and second derivative by its parameter.
struct Heading {
  Vec2 slope;
  Vec2 bend;

  [[nodiscard]] double curvature() const {
    return std::abs(slope.x() * bend.y() - slope.y() * bend.x()) / std::pow(slope.norm(), 3);
  }
};

Heading heading(const SectionArc& arc, const Section& section, bool at_end) {
  if (arc.ellipse >= 0) {
    const EllipseArc& part = section.ellipses[static_cast<std::size_t>(arc.ellipse)];
    const double angle = at_end ? part.begin + part.sweep : part.begin;
    const Vec2 outward = std::cos(angle) * part.ellipse.cosine + std::sin(angle) * part.ellipse.sine;
    const Vec2 onward = std::cos(angle) * part.ellipse.sine - std::sin(angle) * part.ellipse.cosine;
    return {part.sweep < 0.0 ? Vec2(-onward) : onward, -outward};
  }
  const std::uint32_t number = at_end ? arc.first_piece + arc.piece_count - 1 : arc.first_piece;
  const ArcPiece& piece = section.pieces[number];
  const double t = at_end ? 1.0 : 0.0;
  return {piece.slope(t), piece.bend(t)};
}

/// `slack`, mm: how far the node may lie from the arc and from its place on the face.
bool agrees(const Vec2& normal, const Heading& heading, const RowLattice& lattice, double slack) {
  const double side = normal.dot(lattice.along);
  const double rise = heading.slope.dot(lattice.across);
  if (side * rise > 0.0) return true;
  const double grazing = kGrazing + slack * heading.curvature();
  return std::abs(side) <= grazing * normal.norm() || std::abs(rise) <= grazing * heading.slope.norm();
}

}  // namespace

bool keeps_balance(const SectionArc& arc, const Section& section, const RowLattice& lattice, double tolerance) {
  if (arc.begin_normal.isZero(0.0) && arc.end_normal.isZero(0.0)) return true;
  const bool begins = agrees(arc.begin_normal, heading(arc, section, false), lattice, tolerance);
  const bool ends = arc.straight ? begins : agrees(arc.end_normal, heading(arc, section, true), lattice, tolerance);
  if (begins && ends) return true;
  return arc.straight && (arc.end - arc.begin).squaredNorm() <= tolerance * tolerance;
}

}  // namespace lamella::span
