#include "export/grey_png_stack.h"

#include <cmath>
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
  GreyPngSink(std::filesystem::path folder, int bits)
      : folder_(std::move(folder), ".png", true, (1U << bits) - 1U), bits_(bits), white_((1U << bits) - 1U) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    info_ = info;
    plain_ = plain_build(info);
    style_.pixels_per_metre = pixels_per_metre(info.plan.grid);
    blank_ = encode_png(blank_image(), style_);
    folder_.open(plain_.info);
  }

  void write(const Layer& layer) override {
    check_layer(layer, info_);
    // A picture of one material at a time for each thread: a build may have more materials than memory for pictures.
    parallel_for(plain_.info.materials.size(),
                 [&](std::size_t m) { folder_.write_image(layer, m, picture(layer, m)); });
    folder_.add_layer(layer);
  }

  void finish(const SliceReport&) override { folder_.close(); }
  void abandon() noexcept override { folder_.abandon(); }

 private:
  [[nodiscard]] PackedImage blank_image() const { return {info_.plan.grid.size[0], info_.plan.grid.size[1], bits_}; }

  [[nodiscard]] std::string picture(const Layer& layer, std::size_t material) const {
    PackedImage image = blank_image();
    bool is_blank = true;
    MixedRowReader reader(info_);
    for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
      const std::int64_t picture_row = info_.plan.grid.size[1] - 1 - static_cast<std::int64_t>(row);
      reader.read(layer, row, [&](const MixedRun& run) {
        for (std::size_t c = 0; c < run.materials.size(); ++c) {
          if (plain_.ids[run.materials[c].value()] != material) continue;
          is_blank = false;
          paint(run, c, picture_row, image);
        }
      });
    }
    return is_blank ? blank_ : encode_png(image, style_);
  }

  void paint(const MixedRun& run, std::size_t component, std::int64_t row, PackedImage& image) const {
    const auto count = static_cast<std::size_t>(run.pixels.end - run.pixels.begin);
    const std::span<const float> fractions = run.fractions.subspan(component * count, count);
    for (std::size_t n = 0; n < count; ++n) {
      const auto value = static_cast<unsigned>(std::lround(static_cast<double>(fractions[n]) * white_));
      image.set(row, run.pixels.begin + static_cast<std::int64_t>(n), value);
    }
  }

  ImageFolder folder_;
  int bits_;
  unsigned white_;
  BuildInfo info_;
  PlainBuild plain_;
  PngStyle style_;
  std::string blank_;
};

}  // namespace

std::unique_ptr<LayerSink> make_grey_png_sink(const std::filesystem::path& folder, int bits) {
  if (bits != 8 && bits != 16) throw UsageError("grey pictures have 8 or 16 bits a pixel");
  return std::make_unique<GreyPngSink>(folder, bits);
}

}  // namespace lamella
