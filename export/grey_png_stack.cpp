#include "export/grey_png_stack.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "export/build_check.h"
#include "export/image_folder.h"
#include "export/mixed_row.h"
#include "export/png_image.h"

namespace lamella {

namespace {

class GreyPngSink final : public LayerSink {
 public:
  GreyPngSink(std::filesystem::path folder, int bits, PixelChoice choice)
      : folder_(std::move(folder), {.folder_per_material = true, .value = (1U << bits) - 1U}),
        bits_(bits),
        white_((1U << bits) - 1U),
        choice_(choice) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    info_ = info;
    plain_ = plain_build(info);
    style_.pixels_per_metre = pixels_per_metre(info.plan.grid);
    blank_ = encode_png(blank_image(), style_);
    folder_.open(plain_.info);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    // A picture of one material at a time for each thread: a build may have more materials than memory for pictures.
    parallel_for_within(plain_.info.materials.size(),
                        [&](std::size_t m) { folder_.write_image(layer.index, m, picture(layer, m)); });
    return [this, layer = layer.index] { folder_.add_layer(layer, info_.plan.layers[layer]); };
  }

  void finish(const SliceReport&) override { folder_.close(); }
  void abandon() noexcept override { folder_.abandon(); }

 private:
  [[nodiscard]] PackedImage blank_image() const { return {info_.plan.grid.size[0], info_.plan.grid.size[1], bits_}; }

  [[nodiscard]] std::string picture(const Layer& layer, std::size_t material) const {
    PackedImage image = blank_image();
    bool is_blank = true;
    MixedRowReader reader(info_, choice_);
    std::vector<double> shares(static_cast<std::size_t>(image.width()));
    for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
      PixelRun used{image.width(), 0};
      const auto [rows, lines] = lines_of(layer);
      for (std::size_t line = row * lines; line < (row + 1) * lines; ++line) {
        reader.read(*rows, line, [&](const MixedRun& run) {
          for (std::size_t c = 0; c < run.materials.size(); ++c) {
            if (plain_.ids[run.materials[c].value()] == material) add(run, c, shares, used);
          }
        });
      }
      is_blank = is_blank && used.begin >= used.end;
      paint(image.height() - 1 - static_cast<std::int64_t>(row), {used, lines}, shares, image);
    }
    return is_blank ? blank_ : encode_png(image, style_);
  }

  /// The lines that pixels are averaged over, and how many a row of pixels has of them.
  struct Lines {
    const SegmentRows* rows;
    std::size_t per_row;
  };
  [[nodiscard]] Lines lines_of(const Layer& layer) const {
    if (choice_ == PixelChoice::centre || !layer.sub_rows) return {&layer.raster, 1};
    return {&layer.sub_rows->rows, static_cast<std::size_t>(layer.sub_rows->per_row)};
  }

  /// Adds what one component of a run has of its pixels to their shares.
  void add(const MixedRun& run, std::size_t component, std::vector<double>& shares, PixelRun& used) const {
    const auto count = static_cast<std::size_t>(run.pixels.end - run.pixels.begin);
    const std::span<const float> fractions = run.fractions.subspan(component * count, count);
    for (std::size_t n = 0; n < count; ++n) {
      const std::int64_t pixel = run.pixels.begin + static_cast<std::int64_t>(n);
      const double part = choice_ == PixelChoice::centre ? 1.0 : covered(run, pixel);
      shares[static_cast<std::size_t>(pixel)] += part * static_cast<double>(fractions[n]);
    }
    used = {std::min(used.begin, run.pixels.begin), std::max(used.end, run.pixels.end)};
  }

  /// How much of a pixel's width the run's segment covers.
  [[nodiscard]] double covered(const MixedRun& run, std::int64_t pixel) const {
    const Grid& grid = info_.plan.grid;
    const double left = grid.origin.x() + static_cast<double>(pixel) * grid.pitch.x();
    const double right = grid.origin.x() + static_cast<double>(pixel + 1) * grid.pitch.x();
    const double width = std::min(run.x_end, right) - std::max(run.x_begin, left);
    return std::clamp(width / (right - left), 0.0, 1.0);
  }

  /// Paints the pixels of a row and clears their shares.
  struct Used {
    PixelRun pixels;
    std::size_t lines;  ///< whose shares are added up
  };
  void paint(std::int64_t row, const Used& used, std::vector<double>& shares, PackedImage& image) const {
    for (std::int64_t pixel = used.pixels.begin; pixel < used.pixels.end; ++pixel) {
      const double sum = std::exchange(shares[static_cast<std::size_t>(pixel)], 0.0);
      const double share = std::min(sum / static_cast<double>(used.lines), 1.0);
      image.set(row, pixel, static_cast<unsigned>(std::lround(share * white_)));
    }
  }

  ImageFolder folder_;
  int bits_;
  unsigned white_;
  PixelChoice choice_;
  BuildInfo info_;
  PlainBuild plain_;
  PngStyle style_;
  std::string blank_;
};

std::unique_ptr<LayerSink> make_sink(const std::filesystem::path& folder, int bits, PixelChoice choice) {
  if (bits != 8 && bits != 16) throw UsageError("grey pictures have 8 or 16 bits a pixel");
  return std::make_unique<GreyPngSink>(folder, bits, choice);
}

}  // namespace

std::unique_ptr<LayerSink> make_grey_png_sink(const std::filesystem::path& folder, int bits) {
  return make_sink(folder, bits, PixelChoice::centre);
}

std::unique_ptr<LayerSink> make_coverage_png_sink(const std::filesystem::path& folder, int bits) {
  return make_sink(folder, bits, PixelChoice::touched);
}

}  // namespace lamella
