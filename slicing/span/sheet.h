#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "slicing/span/propagate.h"

namespace lamella::span {

/// The arcs of one family over a run of layers: every coefficient of every piece as a polynomial of degree 4 in z,
/// through five exact sections at the run's Chebyshev-Lobatto heights. A layer within the run costs no evaluation of
/// the surface.
class Sheet {
 public:
  static constexpr int kNodes = 5;
  /// A shorter run is not worth a sheet.
  static constexpr std::size_t kFewestLayers = 12;
  /// Points that go farther over a run, in lengths of their pieces, are hardly ever met by a polynomial of this degree.
  static constexpr double kFarthest = 4.0;

  /// Both ends of the arc at a height; false where one can't be placed.
  using EndsAt = std::function<bool(double z, SectionPoint& begin, SectionPoint& end)>;

  /// Builds the sheet from `carried`, an arc at the lower end of [low, high], which is left at the upper end when it
  /// succeeds and as it was when it doesn't. Interior points move on straight lines in (u, v), those on knots along
  /// them. The result is measured against the surface between the nodes, in the middle of every piece.
  ///
  /// Returns the error in terms of what is accepted: 1 or less when it succeeded. Infinite where the points could not
  /// be followed.
  double build(const SectionSurface& surface, double sign, double low, double high, const TraceLimits& limits,
               const EndsAt& ends_at, CarriedArc& carried);

  /// How far the arc's ends may lie off their stored nodes: as far as they did where the sheet is exact, mm. A curve
  /// with a knot between two exact sections shows by more.
  void allow_gap(double gap) { gap_ = std::max(gap_, gap); }
  [[nodiscard]] double gap() const { return gap_; }

  [[nodiscard]] bool covers(double z) const { return !coefficients_.empty() && low_ <= z && z <= high_; }
  void clear() {
    coefficients_.clear();
    gap_ = 0.0;
  }
  [[nodiscard]] std::size_t piece_count() const { return piece_count_; }
  /// Writes piece_count() pieces of the arc at height z.
  void evaluate(double z, ArcPiece* pieces) const;

 private:
  double gap_ = 0.0;
  double low_ = 0.0;
  double high_ = 0.0;
  std::size_t piece_count_ = 0;
  std::vector<double> coefficients_;  ///< [power][piece][12]
};

}  // namespace lamella::span
