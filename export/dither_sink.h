#pragma once

#include <memory>

#include "slicing/layer_sink.h"

namespace lamella {

/// A sink that hands layers on to `inner` in which graded segments are dithered: cut at the edges of pixels into
/// segments of the plain materials that they are mixed of, by a mask of blue noise (docs/methods/dithering.md). `inner`
/// sees no graded material and no hatch rows. The same layers give the same bytes, whatever the number of threads.
[[nodiscard]] std::unique_ptr<LayerSink> make_dither_sink(std::unique_ptr<LayerSink> inner);

}  // namespace lamella
