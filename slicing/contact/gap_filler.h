#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slicing/combine.h"
#include "slicing/contact/contacts.h"
#include "slicing/slab.h"

namespace lamella {

/// A stretch of a row that lies in the gap between two solids that touch.
struct GapFill {
  std::size_t row = 0;  ///< of the lattice, from 0
  Span span;            ///< of the solid of higher rank; it has no faces
  PairLength gap;
};

/// Fills what rows leave open between solids that touch, whatever the direction of the gap: also where a row crosses it
/// at a grazing angle, runs within it, or the whole layer does (docs/methods/interfaces.md).
class GapFiller {
 public:
  /// `contacts` are those of find_contacts(); `rank` decides who gets a gap. What is referred to must outlive it.
  /// `gap_tolerance` (mm) takes the place of the faces' own.
  GapFiller(const SolidDistances& distances, std::span<const Contact> contacts, const IdVector<SolidId, int>& rank,
            const std::optional<double>& gap_tolerance);

  /// The fills of one layer's rows at height z, ascending by row, then along it; they share no point with `spans` and
  /// with each other. Safe from several threads at once.
  void fill(double z, const RowLattice& lattice, const SpanRows& spans, std::vector<GapFill>& out) const;

 private:
  /// Two solids that touch, who gets their gap first.
  struct Touch {
    const Contact* contact = nullptr;
    SolidId first;
    SolidId second;
    double largest_radius = 0.0;  ///< mm
  };
  /// A place of a row at which two solids may leave a gap open.
  struct Candidate {
    std::size_t row = 0;
    std::uint32_t touch = 0;
    double along = 0.0;  ///< mm: the end of an open stretch, or a place of it near a patch
    Interval near;       ///< what is open of the row beside the patch; at an end only that
    double step = 0.0;   ///< mm, by which a gap is followed
    SolidId owner;       ///< whose end it is; none of a patch
  };

  void find_grazed(const Touch& touch, double z, const RowLattice& lattice, const SpanRows& spans,
                   std::vector<Candidate>& out) const;
  void find_ends(const SpanRows& spans, std::vector<Candidate>& out) const;
  void add_end(std::size_t row, SolidId solid, FaceId face, double along, std::vector<Candidate>& out) const;
  [[nodiscard]] double narrow_gap(const Span& left, const Span& right) const;
  class RowSearch;

  const SolidDistances& distances_;
  std::optional<double> gap_tolerance_;
  std::vector<Touch> touches_;                ///< by rank of those who get the gap, then of the others, highest first
  std::vector<std::uint32_t> touches_begin_;  ///< by face id: its entries of touches_of_face_
  std::vector<std::uint32_t> touches_of_face_;
};

}  // namespace lamella
