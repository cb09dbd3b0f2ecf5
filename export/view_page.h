#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// Most raster segments and rows (layers times rows a layer) that a page may hold: beyond, browsers run out of memory.
inline constexpr std::uint64_t kMostViewSegments = 16'000'000;
inline constexpr std::uint64_t kMostViewRows = 40'000'000;

/// Writes one HTML page to look through the layers, with all it needs inside (docs/viewer.md). Of the layers it is
/// given it takes the first and every `every`th after it; `every` is at least 1. write() throws UsageError with a
/// hint when the page would hold more than a browser can take.
[[nodiscard]] std::unique_ptr<LayerSink> make_view_sink(const std::filesystem::path& file, std::uint32_t every);

}  // namespace lamella
