#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"
#include "slicing/hit.h"
#include "slicing/layer.h"

namespace lamella {

/// Parallel lines in a layer's plane: row m is the line across . p = anchor + (m + 1/2) spacing, scanned along `along`.
struct RowLattice {
  Vec2 along = Vec2::UnitX();   ///< unit length
  Vec2 across = Vec2::UnitY();  ///< `along` turned by +90 degrees
  double anchor = 0.0;          ///< mm along `across`
  double spacing = 1.0;         ///< mm
  std::int64_t first_row = 0;
  std::int64_t last_row = 0;  ///< one past

  [[nodiscard]] double position(std::int64_t row) const { return anchor + (static_cast<double>(row) + 0.5) * spacing; }
  [[nodiscard]] std::size_t rows() const { return static_cast<std::size_t>(last_row - first_row); }
  /// The range along `across` that a box takes, mm.
  [[nodiscard]] Interval range_of(const Box3& box) const;
};

/// Spans of all solids on the rows of a lattice in compressed form: row first_row + r holds spans
/// [row_start[r], row_start[r + 1]), ascending by begin, then end, then solid; each solid's own are disjoint.
/// Coordinates are p . along, mm.
struct SpanRows {
  std::vector<std::uint64_t> row_start{0};
  std::vector<Span> spans;

  [[nodiscard]] std::size_t rows() const { return row_start.size() - 1; }
  [[nodiscard]] std::span<const Span> row(std::size_t r) const {
    return {spans.data() + row_start[r], spans.data() + row_start[r + 1]};
  }
};

/// One layer to cut: its plane and the lattices on it.
struct LayerRequest {
  std::size_t layer = 0;  ///< number in the plan, for messages
  double z = 0.0;         ///< mm
  std::vector<RowLattice> lattices;
};

/// A check of an engine on its own work (docs/methods/span-engine.md, Checks).
enum class Check : std::uint8_t {
  closure,  ///< a row enters a solid as often as it leaves it
  winding,  ///< between two crossings a row is either in the solid or not
  balance,  ///< an arc leaves and reaches its nodes on the side that the face's normal has there
  loops,    ///< every loop that is known to be there can be followed
  arcs,     ///< every arc can be followed from node to node
  depth,    ///< every row meets its arc
};

/// What failed a check on one layer. `face` is none where the solid as a whole failed.
struct FailedCheck {
  Check check = Check::closure;
  SolidId solid;
  FaceId face;
  std::uint64_t count = 0;  ///< rows; loops for Check::loops
  double longest = 0.0;     ///< mm, of Check::winding: along the row
};

/// What cutting one layer gave: one SpanRows a lattice, in the order of the request.
struct LayerSpans {
  std::vector<SpanRows> lattices;
  CastCounters cast;
  std::vector<FailedCheck> failed;
};

/// Adds to the entry of the same check, solid and face, or makes one.
void note_failed(std::vector<FailedCheck>& failed, const FailedCheck& more);

/// How many consecutive layers an engine cuts as one unit of work. Slabs begin at multiples of it, whatever the number
/// of threads, so that what an engine carries from layer to layer can't change the result.
inline constexpr std::size_t kSlabLayers = 32;

/// What an engine does for the slicer: cuts a slab of consecutive layers, ascending in z, against the solids it was
/// made for; `out` has one entry a request. Called from several threads at once, each with its own slab.
///
/// `out` comes as make_layer_spans() leaves it, perhaps with memory of earlier slabs in it.
using SlabFunction = std::function<void(std::span<const LayerRequest> slab, std::span<LayerSpans> out)>;

/// The contours of one layer, and what was found on the way.
struct CutContours {
  LayerContours contours;
  std::vector<Finding> findings;
};

/// What an engine that knows whole sections does besides: appends the loops of its solids, ascending by solid, to
/// `out`, which has one entry a request. Called as a SlabFunction is.
using ContourFunction =
    std::function<void(std::span<const LayerRequest> slab, double chord_error, std::span<CutContours> out)>;

/// Makes `out` ready for an engine: one entry a request with one SpanRows a lattice, all without rows and with counters
/// at zero.
void make_layer_spans(std::span<const LayerRequest> slab, std::vector<LayerSpans>& out);

/// Sorts loops by solid, those of a solid in the order in which they are; parents follow.
void sort_loops(LayerContours& contours);

/// Throws GeometryError if an engine didn't give as many rows as a layer was asked for.
void check_layer_spans(const LayerRequest& request, const LayerSpans& spans);

}  // namespace lamella
