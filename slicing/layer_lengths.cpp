#include "slicing/layer_lengths.h"

namespace lamella {

namespace {

void write_values(const std::vector<CompensatedSum>& sums, std::vector<double>& values) {
  values.clear();
  for (const CompensatedSum& sum : sums) values.push_back(sum.value());
}

}  // namespace

void LengthSums::clear(std::size_t solids, std::size_t materials) {
  solids_.assign(solids, {});
  materials_.assign(materials, {});
  overlaps_.clear();
  gaps_.clear();
}

void LengthSums::add(std::span<const Span> spans, const CombinedRow& row) {
  for (const Span& span : spans) solids_[span.solid.value()].add(span.end - span.begin);
  for (const Segment& segment : row.segments) materials_[segment.material.value()].add(segment.x_end - segment.x_begin);
  overlaps_.insert(overlaps_.end(), row.overlaps.begin(), row.overlaps.end());
  gaps_.insert(gaps_.end(), row.gaps.begin(), row.gaps.end());
}

void LengthSums::write(LayerLengths& out) const {
  write_values(solids_, out.solids);
  write_values(materials_, out.materials);
  out.overlaps = overlaps_;
  out.gaps = gaps_;
  collect_pairs(out.overlaps);
  collect_pairs(out.gaps);
}

}  // namespace lamella
