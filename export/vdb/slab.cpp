#include "export/vdb/slab.h"

#include <algorithm>
#include <limits>

namespace lamella {

namespace {

/// Marks among the labels of leaves; no build has as many materials.
constexpr std::uint32_t kUnseen = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kMixed = kUnseen - 1;

std::uint32_t combine(std::uint32_t state, std::uint32_t label) {
  return state == kUnseen || state == label ? label : kMixed;
}

/// Enters voxels [begin, end) of one row into the states of the leaves from `first` on.
void enter(std::vector<std::uint32_t>& states, std::int64_t first, std::int64_t begin, std::int64_t end,
           std::uint32_t label) {
  const std::int64_t whole_begin = (begin + kLeafSide - 1) / kLeafSide;
  const std::int64_t whole_end = end / kLeafSide;
  if (begin % kLeafSide != 0) states[static_cast<std::size_t>(begin / kLeafSide - first)] = kMixed;
  if (end % kLeafSide != 0) states[static_cast<std::size_t>(end / kLeafSide - first)] = kMixed;
  for (std::int64_t leaf = whole_begin; leaf < whole_end; ++leaf) {
    std::uint32_t& state = states[static_cast<std::size_t>(leaf - first)];
    state = combine(state, label);
  }
}

}  // namespace

Slab::Slab(const Grid& grid) : grid_(grid), raster_(grid) {}

void Slab::reset(std::int64_t index) {
  index_ = index;
  runs_.clear();
  for (auto& starts : row_start_) starts.clear();
}

void Slab::add(const Layer& layer, std::int64_t slice) {
  auto& starts = row_start_[static_cast<std::size_t>(slice % kLeafSide)];
  starts.assign(1, runs_.size());
  for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
    raster_.append_runs(layer.raster.row(row), runs_);
    starts.push_back(runs_.size());
  }
}

std::span<const LabelRun> Slab::row(std::int64_t y, std::int64_t z) const {
  const auto& starts = row_start_[static_cast<std::size_t>(z)];
  const auto r = static_cast<std::size_t>(y);
  if (r + 1 >= starts.size()) return {};
  return {runs_.data() + starts[r], runs_.data() + starts[r + 1]};
}

void Slab::visit(const Visitor& visitor) {
  const std::int64_t bands = (grid_.size[1] + kLeafSide - 1) / kLeafSide;
  for (std::int64_t band = 0; band < bands && !empty(); ++band) {
    std::int64_t begin = grid_.size[0];
    std::int64_t end = 0;
    for (std::int64_t line = 0; line < kLeafSide * kLeafSide; ++line) {
      const auto runs = row(band * kLeafSide + line / kLeafSide, line % kLeafSide);
      if (runs.empty()) continue;
      begin = std::min<std::int64_t>(begin, runs.front().begin);
      end = std::max<std::int64_t>(end, runs.back().end);
    }
    if (begin >= end) continue;
    const std::int64_t first = begin / kLeafSide;
    const std::int64_t last = (end + kLeafSide - 1) / kLeafSide;
    classify(band, first, last);
    fill_mixed(band);
    std::size_t next_mixed = 0;
    for (std::int64_t leaf = first; leaf < last; ++leaf) {
      const std::uint32_t state = states_[static_cast<std::size_t>(leaf - first)];
      if (state == kMixed) {
        visitor.mixed(leaf, band, labels_[next_mixed++]);
      } else if (state != 0) {
        visitor.uniform(leaf, band, state);
      }
    }
  }
}

/// Sets states_ of leaves [first, last) of a band and collects the mixed ones.
void Slab::classify(std::int64_t band, std::int64_t first, std::int64_t last) {
  states_.assign(static_cast<std::size_t>(last - first), kUnseen);
  for (std::int64_t line = 0; line < kLeafSide * kLeafSide; ++line) {
    std::int64_t x = first * kLeafSide;
    for (const LabelRun& run : row(band * kLeafSide + line / kLeafSide, line % kLeafSide)) {
      if (x < run.begin) enter(states_, first, x, run.begin, 0);
      enter(states_, first, run.begin, run.end, run.label);
      x = run.end;
    }
    if (x < last * kLeafSide) enter(states_, first, x, last * kLeafSide, 0);
  }
  mixed_.clear();
  for (std::int64_t leaf = first; leaf < last; ++leaf) {
    if (states_[static_cast<std::size_t>(leaf - first)] == kMixed) mixed_.push_back(leaf);
  }
}

/// Sets labels_ of the mixed leaves, each row in one walk along its runs and the leaves.
void Slab::fill_mixed(std::int64_t band) {
  labels_.assign(mixed_.size(), LeafLabels{});
  for (std::int64_t line = 0; line < kLeafSide * kLeafSide; ++line) {
    const auto runs = row(band * kLeafSide + line / kLeafSide, line % kLeafSide);
    auto run = runs.begin();
    for (std::size_t m = 0; m < mixed_.size(); ++m) {
      const std::int64_t x = mixed_[m] * kLeafSide;
      while (run != runs.end() && run->end <= x) ++run;
      for (auto r = run; r != runs.end() && r->begin < x + kLeafSide; ++r) {
        const std::int64_t begin = std::max<std::int64_t>(r->begin - x, 0);
        const std::int64_t end = std::min<std::int64_t>(r->end - x, kLeafSide);
        for (std::int64_t i = begin; i < end; ++i) labels_[m][static_cast<std::size_t>(i * 64 + line)] = r->label;
      }
    }
  }
}

}  // namespace lamella
