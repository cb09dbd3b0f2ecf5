#pragma once

#include <string>
#include <vector>

#include "export/view_chunk.h"
#include "slicing/layer_sink.h"

namespace lamella {

/// One layer of a page, besides its segments.
struct ViewLayer {
  std::uint32_t index = 0;
  std::uint64_t segments = 0;
  std::vector<double> area;      ///< mm^2 of each material, by the rows
  std::int64_t hatch_first = 0;  ///< number of the first hatch row
  std::uint64_t hatch_rows = 0;
};

/// What the page knows besides the chunks, as JSON (docs/viewer.md, "What the page holds").
[[nodiscard]] std::string view_header(const BuildInfo& info, const SliceReport& report,
                                      const std::vector<ViewLayer>& layers, const std::vector<ViewChunkSizes>& chunks);

}  // namespace lamella
