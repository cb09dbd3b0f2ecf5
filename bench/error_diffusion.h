#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella {

/// Two materials by error diffusion, the peer of the dither mask: Floyd and Steinberg's weights, rows to and fro
/// (Ulichney, Digital Halftoning, 1987, 8.3). Rows wait for one another, so it runs on one thread.
///
/// `upward` of each error goes to the voxel above, in the next layer, and the rest to the neighbours within the layer;
/// with 0 layers know nothing of one another.
class ErrorDiffusion {
 public:
  ErrorDiffusion(std::size_t columns, std::size_t rows, float upward)
      : columns_(columns),
        upward_(upward),
        layer_(columns * rows),
        next_layer_(columns * rows),
        row_(columns + 2),
        next_row_(columns + 2) {}

  /// Row `j` of the layer, from 0 on; `fraction` is that of material 1.
  void dither_row(std::size_t j, std::span<const float> fraction, std::span<std::uint8_t> out) {
    const bool back = j % 2 == 1;
    float* const from_below = layer_.data() + j * columns_;
    float* const to_above = next_layer_.data() + j * columns_;
    const std::ptrdiff_t step = back ? -1 : 1;
    float carry = 0.0F;
    for (std::size_t n = 0; n < columns_; ++n) {
      const std::size_t i = back ? columns_ - 1 - n : n;
      const float value = fraction[i] + carry + row_[i + 1] + from_below[i];
      out[i] = value > 0.5F ? 1 : 0;
      const float error = value - static_cast<float>(out[i]);
      to_above[i] = upward_ * error;
      const float share = (1.0F - upward_) * error / 16.0F;
      carry = 7.0F * share;
      float* const next = next_row_.data() + i + 1;
      next[-step] += 3.0F * share;
      next[0] += 5.0F * share;
      next[step] += share;
    }
    row_.swap(next_row_);
    next_row_.assign(next_row_.size(), 0.0F);
  }

  /// Ends a layer.
  void end_layer() {
    layer_.swap(next_layer_);
    row_.assign(row_.size(), 0.0F);
  }

 private:
  std::size_t columns_;
  float upward_;
  std::vector<float> layer_;       ///< errors from the layer below
  std::vector<float> next_layer_;  ///< errors to the layer above
  std::vector<float> row_;         ///< errors from the row before, with a voxel more at both ends
  std::vector<float> next_row_;
};

}  // namespace lamella
