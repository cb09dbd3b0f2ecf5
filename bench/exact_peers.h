#pragma once

#include "bench/peer.h"
#include "model/measure.h"
#include "model/scene.h"
#include "slicing/slab.h"

namespace lamella::bench {

/// A model as the exact engines take it.
struct ExactModel {
  Scene scene;
  std::vector<SolidId> solids;  ///< those that can be sliced
  Box3 bounds;                  ///< of these
};

/// Reads a STEP file. Throws InputError.
[[nodiscard]] ExactModel read_model(const std::string& file);

/// The rows of one layer as the slicer asks for them.
[[nodiscard]] RowLattice row_lattice(const Lattice& lattice);

/// What cuts slabs of a model: the span engine, prepared on one thread.
[[nodiscard]] SlabFunction make_cutter(const ExactModel& model);

/// The reference engine with the certified solver.
[[nodiscard]] std::unique_ptr<Peer> make_reference_peer(const ExactModel& model, const Lattice& lattice);

/// The span engine; with `combine` its spans are also combined into material segments, as a slicing run does.
[[nodiscard]] std::unique_ptr<Peer> make_span_peer(const ExactModel& model, const Lattice& lattice, bool combine);

}  // namespace lamella::bench
