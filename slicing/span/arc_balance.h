#pragma once

#include "slicing/slab.h"
#include "slicing/span/section.h"

namespace lamella::span {

/// Whether an arc leaves its begin and reaches its end on the side that the face's normal n says there: the section
/// runs along z x n, so with d the direction of the rows it comes to lie on a back (n.d > 0, an exit) just where its y
/// rises. Arcs turn between back and front only at turning points of y, which are counted as they are found; so where
/// this holds at both ends of all arcs of a face, fronts and backs balance on the layer:
///
///   fronts that start - fronts that end + turns to front - turns to back = 0.
///
/// The normals were found without the arc: a fold that was lost, a wrong node at an end, or a sweep the wrong way round
/// shows here, where the sum of the crossings of every row can't see it. Chords no longer than `tolerance` (mm) may run
/// backward: their nodes changed places.
[[nodiscard]] bool keeps_balance(const SectionArc& arc, const Section& section, const RowLattice& lattice,
                                 double tolerance);

}  // namespace lamella::span
