#include "export/mixed_row.h"

#include <algorithm>

namespace lamella {

void MixedRowReader::read(const SegmentRows& rows, std::size_t row, const std::function<void(const MixedRun&)>& visit) {
  const Mixtures& mixtures = rows.mixtures;
  const auto first = std::lower_bound(mixtures.segment.begin(), mixtures.segment.end(), rows.row_start[row]) -
                     mixtures.segment.begin();
  auto g = static_cast<std::size_t>(first);
  for (std::uint64_t i = rows.row_start[row]; i < rows.row_start[row + 1]; ++i) {
    const Segment& segment = rows.segments[i];
    const PixelRun pixels = choice_ == PixelChoice::centre ? raster_.pixels(segment) : raster_.touched(segment);
    const bool is_mixed = g < mixtures.segment.size() && mixtures.segment[g] == i;
    const std::size_t mixture = is_mixed ? g++ : g;
    if (pixels.begin >= pixels.end) continue;
    if (!is_mixed) {
      fractions_.assign(static_cast<std::size_t>(pixels.end - pixels.begin), 1.0F);
      visit({pixels, segment.solid, segment.material, segment.x_begin, segment.x_end, std::span(&segment.material, 1),
             fractions_});
      continue;
    }
    const std::vector<MaterialId>& components = info_.materials[segment.material].components;
    sample(mixtures, mixture, pixels, components.size());
    visit({pixels, segment.solid, segment.material, segment.x_begin, segment.x_end, components, fractions_});
  }
}

void MixedRowReader::sample(const Mixtures& mixtures, std::size_t g, const PixelRun& pixels, std::size_t components) {
  const std::span<const double> x = mixtures.knots(g);
  const std::span<const float> known = mixtures.fractions(g);
  const auto count = static_cast<std::size_t>(pixels.end - pixels.begin);
  fractions_.resize(count * components);
  std::size_t behind = 0;  // the first knot that isn't before the pixel
  for (std::size_t n = 0; n < count; ++n) {
    const double centre = pixel_centre(info_.plan.grid.origin.x(), info_.plan.grid.pitch.x(),
                                       pixels.begin + static_cast<std::int64_t>(n));
    while (behind < x.size() && x[behind] < centre) ++behind;
    const std::size_t to = std::min(behind, x.size() - 1);
    const std::size_t from = behind == 0 || behind == x.size() ? to : behind - 1;
    const auto part = from == to ? 0.0F : static_cast<float>((centre - x[from]) / (x[to] - x[from]));
    for (std::size_t c = 0; c < components; ++c) {
      const float before = known[from * components + c];
      const float after = known[to * components + c];
      // Between two zeros nothing but zero may come out.
      fractions_[c * count + n] = (1.0F - part) * before + part * after;
    }
  }
}

PlainBuild plain_build(const BuildInfo& info) {
  PlainBuild plain{info, {}};
  plain.info.plan.hatch.reset();
  plain.info.plan.chord_error.reset();
  plain.info.materials = {};
  for (const Material& material : info.materials) {
    plain.ids.push_back(plain.info.materials.size());
    if (!material.is_graded()) plain.info.materials.push_back(material);
  }
  for (BuildSolid& solid : plain.info.solids) {
    const Material& material = info.materials[solid.material];
    const MaterialId stands_for = material.is_graded() ? material.components.front() : solid.material;
    solid.material = MaterialId{plain.ids[stands_for.value()]};
  }
  return plain;
}

}  // namespace lamella
