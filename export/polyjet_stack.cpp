#include "export/polyjet_stack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <vector>

#include "core/error.h"
#include "export/build_check.h"
#include "export/image_folder.h"
#include "export/png_image.h"
#include "export/raster_row.h"
#include "export/uniform_z.h"

namespace lamella {

namespace {

constexpr std::size_t kMaxMaterials = 6;
constexpr double kPitchTolerance = 1e-3;  // of the pitch: a pixel on a bed of 1000 columns
constexpr std::uint32_t kBackground = 0x000000FF;

/// Dots per inch and slice thicknesses, mm, of the two families of machines.
struct Lattice {
  double dpi_x, dpi_y;
  std::vector<double> thicknesses;
};
const std::array<Lattice, 2> kLattices = {Lattice{600.0, 300.0, {0.027, 0.014}}, Lattice{300.0, 300.0, {0.01875}}};

bool is_near(double value, double target) { return std::abs(value - target) <= kPitchTolerance * target; }

void check_lattice(const Vec3& pitch) {
  for (const Lattice& lattice : kLattices) {
    if (!is_near(pitch.x(), 25.4 / lattice.dpi_x) || !is_near(pitch.y(), 25.4 / lattice.dpi_y)) continue;
    const auto& known = lattice.thicknesses;
    if (std::any_of(known.begin(), known.end(), [&](double t) { return is_near(pitch.z(), t); })) return;
    throw UsageError(fmt::format("PolyJet machines have no slices of {} mm", pitch.z()), "--layer-height",
                     lattice.dpi_x == 600.0 ? "slice with 0.027 or 0.014" : "slice with 0.01875");
  }
  throw UsageError(fmt::format("PolyJet machines have no pixels of {} x {} mm", pitch.x(), pitch.y()), "--dpi",
                   "slice with --dpi 600,300, or --dpi 300,300 for a J55");
}

std::uint32_t color_of(const Material& material) {
  std::uint32_t value = 0;
  for (const double channel : material.color) {
    value = value << 8 | static_cast<std::uint32_t>(std::lround(std::clamp(channel, 0.0, 1.0) * 255.0));
  }
  return value << 8 | 0xFFU;
}

/// The materials' colours, which alone tell them apart.
std::vector<std::uint32_t> distinct_colors(const IdVector<MaterialId, Material>& materials) {
  if (materials.size() > kMaxMaterials) {
    throw UsageError(fmt::format("PolyJet machines take at most 6 materials, this build has {}", materials.size()), "",
                     "give fewer in the materials file; graded ones count, without --dither");
  }
  std::vector<std::uint32_t> colors;
  for (const Material& material : materials) {
    const std::uint32_t color = color_of(material);
    if (color == kBackground) {
      throw UsageError("'" + material.name + "' is black, the colour of void", "",
                       "give it another colour in the materials file");
    }
    const auto same = std::find(colors.begin(), colors.end(), color);
    if (same != colors.end()) {
      const Material& other = materials[MaterialId{static_cast<std::size_t>(same - colors.begin())}];
      throw UsageError("'" + material.name + "' has the colour of '" + other.name + "'", "",
                       "give them different colours in the materials file");
    }
    colors.push_back(color);
  }
  return colors;
}

class PolyjetSink final : public LayerSink {
 public:
  PolyjetSink(std::filesystem::path folder, const PolyjetOptions& options)
      : place_(folder.string()), folder_(std::move(folder), {.pads_number = false}), options_(options) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    info_ = info;
    uniform_.emplace(info.plan, options_.z_pitch, "PolyJet");
    BuildInfo shown = info;
    Grid& grid = shown.plan.grid;
    grid.origin.z() = uniform_->bottom();
    grid.pitch.z() = uniform_->pitch();
    grid.size[2] = uniform_->count();
    check_lattice(grid.pitch);
    colors_ = distinct_colors(info.materials);
    check_count(count_given());
    style_.pixels_per_metre = pixels_per_metre(grid);
    const PackedImage fits(grid.size[0], grid.size[1], 32);
    folder_.open(shown);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    const SliceRange slices = uniform_->slices(layer.index);
    if (slices.begin == slices.end) return [] {};
    return [this, slices, bytes = picture(layer)] {
      for (std::int64_t slice = slices.begin; slice < slices.end; ++slice) write_slice(slice, bytes);
    };
  }

  void finish(const SliceReport&) override {
    check_count(written_);
    folder_.close();
  }
  void abandon() noexcept override { folder_.abandon(); }

 private:
  /// Slices that the layers to come make.
  [[nodiscard]] std::int64_t count_given() const {
    const std::size_t last = std::min<std::size_t>(info_.given.last, info_.plan.layers.size());
    const SliceRange range = uniform_->slices(std::min<std::size_t>(info_.given.first, last), last);
    return range.end - range.begin;
  }

  void check_count(std::int64_t slices) const {
    if (slices >= options_.fewest_slices) return;
    throw UsageError(
        fmt::format("PolyJet machines take at least {} slices, here are {}", options_.fewest_slices, slices), place_,
        "take more layers");
  }

  void write_slice(std::int64_t slice, const std::string& bytes) {
    const double bottom = uniform_->bottom() + static_cast<double>(slice) * uniform_->pitch();
    const double top = uniform_->bottom() + static_cast<double>(slice + 1) * uniform_->pitch();
    const auto number = static_cast<std::uint32_t>(written_++);
    folder_.write_image(number, 0, bytes);
    folder_.add_layer(number, {bottom, 0.5 * (bottom + top), top});
  }

  [[nodiscard]] std::string picture(const Layer& layer) const {
    const Grid& grid = info_.plan.grid;
    PackedImage image(grid.size[0], grid.size[1], 32);
    const RowRaster raster(grid);
    std::vector<LabelRun> runs;
    for (std::int64_t row = 0; row < grid.size[1]; ++row) {
      runs.clear();
      raster.append_runs(layer.raster.row(static_cast<std::size_t>(row)), runs);
      const std::int64_t picture_row = grid.size[1] - 1 - row;
      image.fill(picture_row, 0, grid.size[0], kBackground);
      for (const LabelRun& run : runs) image.fill(picture_row, run.begin, run.end, colors_[run.label - 1]);
    }
    return encode_png(image, style_);
  }

  std::string place_;
  ImageFolder folder_;
  PolyjetOptions options_;
  BuildInfo info_;
  std::optional<UniformZ> uniform_;
  std::vector<std::uint32_t> colors_;
  PngStyle style_;
  std::int64_t written_ = 0;
};

}  // namespace

std::unique_ptr<LayerSink> make_polyjet_sink(const std::filesystem::path& folder, const PolyjetOptions& options) {
  return std::make_unique<PolyjetSink>(folder, options);
}

}  // namespace lamella
