#pragma once

#include <cmath>
#include <vector>

#include "model/scene.h"
#include "slicing/span/section.h"

/// Sections made by hand, for what comes after cutting.
namespace lamella::test {

/// A scene of one nameless face and solid, for findings.
inline const Scene& one_solid() {
  static const Scene scene = [] {
    Scene made;
    made.solids.push_back({});
    made.faces.push_back({});
    return made;
  }();
  return scene;
}

/// Straight arcs from corner to corner and back to the first.
inline void add_polygon(span::Section& section, const std::vector<Vec2>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2& a = corners[i];
    const Vec2& b = corners[(i + 1) % corners.size()];
    section.arcs.push_back({FaceId{0}, a, b, static_cast<std::uint32_t>(section.pieces.size()), 1, true});
    section.pieces.push_back(span::straight_piece(a, b));
  }
}

/// One arc about `center` from angle `from` over `sweep`, within 1e-8 of the radius; a whole turn ends where it began.
inline void add_arc_of_circle(span::Section& section, const Vec2& center, double radius, double from, double sweep) {
  const int count = 40;
  const auto at = [&](double angle) -> Vec2 { return center + radius * Vec2(std::cos(angle), std::sin(angle)); };
  const Vec2 begin = at(from);
  const bool whole = std::abs(std::abs(sweep) - kTwoPi) < 1e-12;
  section.arcs.push_back({FaceId{0}, begin, whole ? begin : at(from + sweep),
                          static_cast<std::uint32_t>(section.pieces.size()), static_cast<std::uint32_t>(count)});
  for (int i = 0; i < count; ++i) {
    // Taylor about the piece's middle, moved to t in [0, 1]: h (t - 1/2) is the angle from there.
    const double h = sweep / count;
    const double middle = from + (i + 0.5) * h;
    const double taylor[6] = {1.0, h, h * h / 2, h * h * h / 6, std::pow(h, 4) / 24, std::pow(h, 5) / 120};
    span::ArcPiece piece;
    for (int k = 0; k < 6; ++k) {
      // Derivatives of the cosine and the sine go round by quarter turns.
      const double c = radius * std::cos(middle + k * 0.5 * kPi) * taylor[k];
      const double s = radius * std::sin(middle + k * 0.5 * kPi) * taylor[k];
      double binomial = 1.0;
      for (int j = k; j >= 0; --j) {  // (t - 1/2)^k
        piece.x[j] += c * binomial * std::pow(-0.5, k - j);
        piece.y[j] += s * binomial * std::pow(-0.5, k - j);
        binomial = binomial * j / (k - j + 1);
      }
    }
    piece.x[0] += center.x();
    piece.y[0] += center.y();
    section.pieces.push_back(piece);
  }
}

/// The same section with every arc of several pieces cut into two in its middle.
inline span::Section halved(const span::Section& section) {
  span::Section result;
  result.pieces = section.pieces;
  for (const span::SectionArc& arc : section.arcs) {
    const std::uint32_t half = arc.piece_count / 2;
    span::SectionArc first = arc;
    span::SectionArc second = arc;
    first.piece_count = half;
    second.first_piece += half;
    second.piece_count -= half;
    first.end = second.begin = section.pieces[second.first_piece].at(0.0);
    result.arcs.push_back(first);
    result.arcs.push_back(second);
  }
  return result;
}

}  // namespace lamella::test
