#pragma once

#include "bench/mesh.h"
#include "bench/peer.h"

namespace lamella::bench {

/// Contour slicer: sweeps the triangles by height, cuts those that a layer meets into segments, and scan-converts the
/// segments.
[[nodiscard]] std::unique_ptr<Peer> make_contour_peer(const ModelMesh& mesh, const Lattice& lattice);

/// Dexel rasteriser: scan-converts each triangle's shadow on the (y, z) plane into buckets of rows, a slab of layers at
/// a time.
[[nodiscard]] std::unique_ptr<Peer> make_dexel_peer(const ModelMesh& mesh, const Lattice& lattice);

/// Embree: packets of 16 rays through a tree of boxes over the triangles, all hits by a filter function.
[[nodiscard]] std::unique_ptr<Peer> make_embree_peer(const ModelMesh& mesh, const Lattice& lattice);

}  // namespace lamella::bench
