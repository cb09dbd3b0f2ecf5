#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "export/material_contours.h"
#include "slicing/layer.h"

namespace lamella {

/// What a stretch of a loop runs along: a line or the whole of a curve of a section.
struct CurveCarrier {
  std::optional<CurveKind> kind;     ///< none of a line
  std::array<double, 12> numbers{};  ///< as ContourCurve has them; of a line x and y of both ends, mm

  /// The point at t, which runs from 0 to 1 along the whole carrier and may go beyond.
  [[nodiscard]] Vec2 at(double t) const;
  /// Derivative by t, mm.
  [[nodiscard]] Vec2 slope(double t) const;
  /// The parameter of the point next to `point`, found from `near`; of lines and ellipses it needs no `near` but to
  /// tell turns apart.
  [[nodiscard]] double nearest(const Vec2& point, double near) const;
};

/// A stretch of a loop: `carrier` from parameter `begin` to `end`, either way round.
struct CurveStretch {
  CurveCarrier carrier;
  double begin = 0.0;
  double end = 1.0;

  [[nodiscard]] Vec2 first() const { return carrier.at(begin); }
  [[nodiscard]] Vec2 last() const { return carrier.at(end); }
};

/// Puts the curves of solids' sections in place of the sides of material loops of the same layer. Where a loop changes
/// from one solid's curve to another's, both end where they cross, not where their chords do. Sides that are on no
/// solid's loop, as the overlap policies entry, exit and average make them, stay straight. What joins nowhere to 1e-6
/// mm is joined by a line; stretches of no more length are left out.
class CurveFollower {
 public:
  /// `contours` must outlive it. `chord_error` is how far its polygons may be from the curves, mm.
  CurveFollower(const LayerContours& contours, double chord_error);

  /// In the order of the loop, closed; begins where a stretch does.
  [[nodiscard]] std::vector<CurveStretch> follow(const MaterialLoop& loop) const;

 private:
  struct Corner {
    std::int64_t x = 0;
    std::int64_t y = 0;
    std::uint64_t side = 0;  ///< that begins there

    auto operator<=>(const Corner&) const = default;
  };
  /// What a side of a material loop lies on.
  struct Source {
    std::int64_t side = -1;  ///< of the contours; -1: nothing
    std::int64_t curve = -1;
    bool forward = true;

    bool operator==(const Source&) const = default;
  };
  /// Consecutive sides on one carrier.
  struct Run {
    CurveStretch stretch;
    Vec2 from;  ///< corners of the material loop
    Vec2 to;
    bool begins_whole = false;  ///< at an end of the carrier
    bool ends_whole = false;
  };

  [[nodiscard]] std::uint64_t next(std::uint64_t side) const;
  [[nodiscard]] std::uint64_t previous(std::uint64_t side) const;
  [[nodiscard]] std::vector<std::uint64_t> sides_from(const Vec2& corner) const;
  [[nodiscard]] bool reaches(std::uint64_t side, bool forward, const Vec2& from, const Vec2& to) const;
  [[nodiscard]] Source source_of(const Vec2& from, const Vec2& to, const Source& before) const;
  [[nodiscard]] Run run_of(const MaterialLoop& loop, const std::vector<Source>& sources, std::size_t first,
                           std::size_t count) const;
  [[nodiscard]] bool continues(const MaterialLoop& loop, const std::vector<Source>& sources, std::size_t side) const;
  void join(Run& a, Run& b) const;

  const LayerContours& contours_;
  double chord_error_;
  std::vector<Corner> corners_;         ///< sorted
  std::vector<std::int64_t> curve_of_;  ///< by side; -1: straight
  std::vector<std::uint64_t> loop_of_;  ///< by side
};

}  // namespace lamella
