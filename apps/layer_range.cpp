#include "apps/layer_range.h"

#include <algorithm>

#include "apps/options.h"

namespace lamella::apps {

LayerRange parse_layers(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw UsageError("'" + text + "' is no range of layers", "--layers", "write A:B for layers A to B - 1");
  }
  constexpr long kMost = 0x7FFFFFFF;
  LayerRange range;
  const std::string first = text.substr(0, colon);
  const std::string last = text.substr(colon + 1);
  if (!first.empty()) range.first = static_cast<std::uint32_t>(parse_whole("--layers", first, 0, kMost));
  if (!last.empty()) range.last = static_cast<std::uint32_t>(parse_whole("--layers", last, 0, kMost));
  if (range.first >= range.last) {
    throw UsageError("'" + text + "' holds no layer", "--layers", "write A:B for layers A to B - 1, A < B");
  }
  return range;
}

LayerRange clip(LayerRange range, std::size_t layers) {
  if (range.first >= layers) {
    throw UsageError("the build has " + std::to_string(layers) + " layers", "--layers", "they count from 0");
  }
  range.last = static_cast<std::uint32_t>(std::min<std::size_t>(range.last, layers));
  return range;
}

}  // namespace lamella::apps
