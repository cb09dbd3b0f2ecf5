#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// Most segments and rows (layers times rows a layer) that a page may hold: beyond, browsers run out of memory.
inline constexpr std::uint64_t kMostViewSegments = 16'000'000;
inline constexpr std::uint64_t kMostViewRows = 40'000'000;

struct ViewPageOptions {
  std::uint32_t every = 1;  ///< of the layers given the first and every `every`th after it; at least 1
  bool hatches = false;     ///< hatch rows besides
};

/// Writes one HTML page to look through the layers, with all it needs inside (docs/viewer.md). begin() throws
/// UsageError for hatches of a build that has none, write() with a hint when the page would hold more than a browser
/// can take.
[[nodiscard]] std::unique_ptr<LayerSink> make_view_sink(const std::filesystem::path& file,
                                                        const ViewPageOptions& options = {});

}  // namespace lamella
