#pragma once

#include <cstdint>
#include <vector>

#include "model/scene.h"
#include "slicing/slab.h"
#include "slicing/span/span_engine.h"

/// Scenes cut by the span engine outside of a slicer.
namespace lamella::test {

/// `rows` rows at `angle` radians, the first at half a spacing above `anchor`. Exact axes at multiples of 90 degrees.
[[nodiscard]] RowLattice make_lattice(double angle, double anchor, double spacing, std::int64_t rows);
/// Rows that cover a box, `shift` (in [0, 1)) of a spacing aside.
[[nodiscard]] RowLattice lattice_over(const Box3& box, double angle, std::int64_t rows, double shift = 0.0);

/// The line along one row of a lattice; its parameter is the spans' coordinate.
[[nodiscard]] Ray ray_of(const RowLattice& lattice, std::int64_t row, double z);

/// Exact bounds of a solid's faces and of its vertices.
[[nodiscard]] Box3 solid_box(const Scene& scene, SolidId solid);
[[nodiscard]] Box3 scene_box(const Scene& scene);

/// Solids that are closed and not damaged.
[[nodiscard]] std::vector<SolidId> sound_solids(const Scene& scene);
[[nodiscard]] std::vector<SolidId> all_solids(const Scene& scene);

/// Cuts requests (ascending in z) as the slicer does, in slabs of kSlabLayers.
[[nodiscard]] std::vector<LayerSpans> cut_layers(const SpanEngine& engine, const std::vector<LayerRequest>& requests);
/// One layer with one lattice.
[[nodiscard]] SpanRows cut_layer(const SpanEngine& engine, double z, const RowLattice& lattice,
                                 CastCounters* counters = nullptr);

/// The spans of one solid on a row.
[[nodiscard]] std::vector<Interval> spans_of(const SpanRows& rows, std::size_t row, SolidId solid);
/// The spans of all rows and solids, one after the other.
[[nodiscard]] std::vector<Interval> spans_of_all(const SpanRows& rows);
/// Spans without those of at most `slack` mm, joined over gaps of at most `slack`.
[[nodiscard]] std::vector<Interval> merged(std::vector<Interval> spans, double slack);

/// Counters of all layers together.
[[nodiscard]] CastCounters total(const std::vector<LayerSpans>& layers);

}  // namespace lamella::test
