#include "bench/row_buckets.h"

namespace lamella::bench {

RowBuckets::RowBuckets(std::int32_t first_row, std::int32_t last_row, std::int32_t layers)
    : first_row_(first_row),
      last_row_(last_row),
      layer_stride_((last_row - first_row + kRowBlock - 1) / kRowBlock * kRowBlock),
      stride_(layer_stride_ * layers),
      counts_(static_cast<std::size_t>(stride_), 0),
      slots_(static_cast<std::size_t>(stride_) * capacity_) {}

void RowBuckets::clear() { std::fill(counts_.begin(), counts_.end(), 0); }

bool RowBuckets::grow_if_full() {
  const auto most = std::max_element(counts_.begin(), counts_.end());
  if (most == counts_.end() || *most <= capacity_) return true;
  while (capacity_ < *most) capacity_ *= 2;
  slots_.resize(static_cast<std::size_t>(stride_) * capacity_);
  return false;
}

void RowBuckets::sort() { sort_slots(slots_.data(), counts_.data(), stride_, stride_); }

void RowBuckets::visit(std::size_t solid, std::int32_t first_layer, std::int32_t layers,
                       const RowVisitor& visitor) const {
  std::vector<double> x;
  for (std::int32_t k = 0; k < layers; ++k) {
    for (std::int32_t row = first_row_; row < last_row_; ++row) {
      const std::int32_t at = k * layer_stride_ + row - first_row_;
      x.clear();
      for (std::int32_t s = 0; s < counts_[at]; ++s) x.push_back(slots_[static_cast<std::size_t>(s) * stride_ + at]);
      if (!x.empty()) visitor(solid, first_layer + k, row, x);
    }
  }
}

}  // namespace lamella::bench
