#include "slicing/layer_lengths.h"

#include <algorithm>
#include <utility>

namespace lamella {

namespace {

void write_values(const std::vector<CompensatedSum>& sums, std::vector<double>& values) {
  values.clear();
  for (const CompensatedSum& sum : sums) values.push_back(sum.value());
}

/// Adds length(item) to sums[id(item)] for all items of a row. Neighbours of one id are added up before: a chain of
/// additions in a register costs a quarter of one through memory.
template <class Item, class Id, class Length>
void add_lengths(std::vector<CompensatedSum>& sums, std::span<const Item> items, const Id& id, const Length& length) {
  for (std::size_t i = 0; i < items.size();) {
    const std::size_t index = id(items[i]);
    double run = length(items[i]);
    while (++i < items.size() && id(items[i]) == index) run += length(items[i]);
    sums[index].add(run);
  }
}

}  // namespace

void PairSums::clear() {
  for (const std::uint32_t slot : used_) slots_[slot] = {};
  used_.clear();
}

/// Where the pair is, or the free slot where it belongs.
std::size_t PairSums::find(SolidId first, SolidId second) const {
  // Two odd constants with well mixed bits (those of xxHash); neighbouring ids are usual.
  const std::uint64_t mixed = (first.value() * 0x9E3779B185EBCA87U) ^ (second.value() * 0xC2B2AE3D27D4EB4FU);
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = (mixed >> 32U) & mask;
  while (slots_[slot].first.valid() && (slots_[slot].first != first || slots_[slot].second != second)) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

void PairSums::grow() {
  std::vector<Slot> old(slots_.empty() ? 64 : 2 * slots_.size());
  old.swap(slots_);
  for (std::uint32_t& slot : used_) {
    const std::size_t place = find(old[slot].first, old[slot].second);
    slots_[place] = old[slot];
    slot = static_cast<std::uint32_t>(place);
  }
}

void PairSums::add(const PairLength& length) {
  if (2 * (used_.size() + 1) > slots_.size()) grow();
  const std::size_t place = find(length.first, length.second);
  Slot& slot = slots_[place];
  if (!slot.first.valid()) {
    slot.first = length.first;
    slot.second = length.second;
    used_.push_back(static_cast<std::uint32_t>(place));
  }
  slot.sum.add(length.length);
}

void PairSums::write(std::vector<PairLength>& out) const {
  out.clear();
  for (const std::uint32_t slot : used_) {
    out.push_back({slots_[slot].first, slots_[slot].second, slots_[slot].sum.value()});
  }
  std::sort(out.begin(), out.end(), [](const PairLength& a, const PairLength& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
}

void LengthSums::clear(std::size_t solids, std::size_t materials) {
  solids_.assign(solids, {});
  materials_.assign(materials, {});
  overlaps_.clear();
  gaps_.clear();
}

void LengthSums::add(std::span<const Span> spans, std::span<const Segment> segments, const RowCombiner& row) {
  add_lengths(
      solids_, spans, [](const Span& span) { return span.solid.value(); },
      [](const Span& span) { return span.end - span.begin; });
  add_lengths(
      materials_, segments, [](const Segment& segment) { return segment.material.value(); },
      [](const Segment& segment) { return segment.x_end - segment.x_begin; });
  for (const PairLength& overlap : row.overlaps()) overlaps_.add(overlap);
  for (const PairLength& gap : row.gaps()) gaps_.add(gap);
}

void LengthSums::write(LayerLengths& out) const {
  write_values(solids_, out.solids);
  write_values(materials_, out.materials);
  overlaps_.write(out.overlaps);
  gaps_.write(out.gaps);
}

}  // namespace lamella
