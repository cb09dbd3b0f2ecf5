#include "export/png_stack.h"

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "export/build_check.h"
#include "export/image_folder.h"
#include "export/material_runs.h"
#include "export/png_image.h"
#include "export/raster_row.h"

namespace lamella {

namespace {

constexpr std::size_t kMaxIndexedMaterials = 255;  // 8-bit indices, one of which is void

/// Calls visit(picture_row, run) for the runs of a layer, rows from the first to the last.
template <class Visit>
void visit_runs(const Layer& layer, const Grid& grid, const Visit& visit) {
  const RowRaster raster(grid);
  std::vector<LabelRun> runs;
  for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
    runs.clear();
    raster.append_runs(layer.raster.row(row), runs);
    for (const LabelRun& run : runs) visit(picture_row(grid, row), run);
  }
}

/// Black pictures with the material in white, one stack per material.
class PngSink final : public LayerSink {
 public:
  explicit PngSink(std::filesystem::path folder) : folder_(std::move(folder), {.folder_per_material = true}) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    info_ = info;
    style_.pixels_per_metre = pixels_per_metre(info.plan.grid);
    blank_ = encode_png(blank_image(), style_);
    folder_.open(info);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    const auto runs = runs_by_material(layer, info_);
    parallel_for_within(runs.size(), [&](std::size_t m) { folder_.write_image(layer.index, m, picture(runs[m])); });
    return [this, layer = layer.index] { folder_.add_layer(layer, info_.plan.layers[layer]); };
  }

  void finish(const SliceReport&) override { folder_.close(); }
  void abandon() noexcept override { folder_.abandon(); }

 private:
  [[nodiscard]] PackedImage blank_image() const { return {info_.plan.grid.size[0], info_.plan.grid.size[1], 1}; }

  [[nodiscard]] std::string picture(std::span<const RowRun> runs) const {
    if (runs.empty()) return blank_;
    PackedImage image = blank_image();
    for (const RowRun& run : runs) image.fill(run.picture_row, run.pixels.begin, run.pixels.end, 1);
    return encode_png(image, style_);
  }

  ImageFolder folder_;
  BuildInfo info_;
  PngStyle style_;
  std::string blank_;  // most layers lack some material
};

/// Smallest bit depth of PNG that holds `values` different values.
int index_bits(std::size_t values) {
  int bits = 1;
  while ((std::size_t{1} << bits) < values) bits *= 2;
  return bits;
}

/// One picture per layer whose pixels are material numbers.
class IndexedPngSink final : public LayerSink {
 public:
  explicit IndexedPngSink(std::filesystem::path folder) : folder_(std::move(folder), {}) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    if (info.materials.size() > kMaxIndexedMaterials) {
      throw UsageError(
          "an indexed PNG holds at most 255 materials, this build has " + std::to_string(info.materials.size()), "",
          "use one stack per material (--png)");
    }
    info_ = info;
    bits_ = index_bits(info.materials.size() + 1);
    style_.pixels_per_metre = pixels_per_metre(info.plan.grid);
    style_.palette = {Color{0.0, 0.0, 0.0}};
    for (const Material& material : info.materials) style_.palette.push_back(material.color);
    const PackedImage fits(info.plan.grid.size[0], info.plan.grid.size[1], bits_);
    folder_.open(info);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    const Grid& grid = info_.plan.grid;
    PackedImage image(grid.size[0], grid.size[1], bits_);
    visit_runs(layer, grid,
               [&](std::int64_t row, const LabelRun& run) { image.fill(row, run.begin, run.end, run.label); });
    folder_.write_image(layer.index, 0, encode_png(image, style_));
    return [this, layer = layer.index] { folder_.add_layer(layer, info_.plan.layers[layer]); };
  }

  void finish(const SliceReport&) override { folder_.close(); }
  void abandon() noexcept override { folder_.abandon(); }

 private:
  ImageFolder folder_;
  BuildInfo info_;
  PngStyle style_;
  int bits_ = 1;
};

}  // namespace

std::unique_ptr<LayerSink> make_png_sink(const std::filesystem::path& folder) {
  return std::make_unique<PngSink>(folder);
}

std::unique_ptr<LayerSink> make_indexed_png_sink(const std::filesystem::path& folder) {
  return std::make_unique<IndexedPngSink>(folder);
}

}  // namespace lamella
