#pragma once

#include <filesystem>

#include "bench/peer.h"

namespace lamella::bench {

/// OpenCASCADE's exact rays: IntCurvesFace_ShapeIntersector, solid by solid whose box the row meets.
[[nodiscard]] std::unique_ptr<Peer> make_occt_peer(const std::filesystem::path& file, const Lattice& lattice);

}  // namespace lamella::bench
