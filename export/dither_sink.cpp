#include "export/dither_sink.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/error.h"
#include "export/build_check.h"
#include "export/mixed_row.h"
#include "slicing/dither_band.h"

namespace lamella {

namespace {

/// dither_row() tells no more materials apart.
constexpr std::size_t kMaxComponents = 256;

/// A run of a band of rows, whose materials are chosen when the whole band is known.
struct BandRun {
  std::size_t row;
  PixelRun pixels;
  SolidId solid;
  std::span<const MaterialId> materials;
  std::size_t number;  ///< in the band, if there are several materials
};

class DitherSink final : public LayerSink {
 public:
  explicit DitherSink(std::unique_ptr<LayerSink> inner) : inner_(std::move(inner)) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    for (const Material& material : info.materials) {
      if (material.components.size() > kMaxComponents) {
        throw UsageError("'" + material.name + "' has too many components to be dithered");
      }
    }
    info_ = info;
    plain_ = plain_build(info);
    mask_.emplace(info.plan.grid.pitch);
    inner_->begin(plain_.info);
  }

  void write(const Layer& layer) override { inner_->write(dithered(layer)); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    const auto plain = std::make_shared<const Layer>(dithered(layer));
    return [plain, rest = inner_->prepare(*plain)] { rest(); };
  }

  void finish(const SliceReport& report) override { inner_->finish(plain_report(report)); }
  void abandon() noexcept override { inner_->abandon(); }

 private:
  [[nodiscard]] Layer dithered(const Layer& layer) const {
    check_layer(layer, info_);
    Layer out;
    out.index = layer.index;
    out.z_bottom = layer.z_bottom;
    out.z_sample = layer.z_sample;
    out.z_top = layer.z_top;
    MixedRowReader reader(info_);
    DitherBand band(*mask_);
    const std::size_t rows = layer.raster.rows();
    for (std::size_t begin = 0; begin < rows; begin += DitherBand::kRows) {
      append_band(reader, layer, begin, std::min(rows, begin + DitherBand::kRows), band, out.raster);
    }
    return out;
  }

  /// Rows [begin, end), which are a band's.
  void append_band(MixedRowReader& reader, const Layer& layer, std::size_t begin, std::size_t end, DitherBand& band,
                   SegmentRows& out) const {
    std::vector<BandRun> runs;
    band.begin();
    for (std::size_t row = begin; row < end; ++row) {
      reader.read(layer.raster, row, [&](const MixedRun& run) {
        runs.push_back({row, run.pixels, run.solid, run.materials, 0});
        if (run.materials.size() < 2) return;
        const VoxelIndex first{run.pixels.begin, static_cast<std::int64_t>(row), layer.index};
        const auto count = static_cast<std::size_t>(run.pixels.end - run.pixels.begin);
        runs.back().number = band.add(run.material.value(), first, run.fractions, count);
      });
    }
    band.settle();
    auto run = runs.begin();
    for (std::size_t row = begin; row < end; ++row) {
      for (; run != runs.end() && run->row == row; ++run) append_run(*run, band, out.segments);
      out.row_start.push_back(out.segments.size());
    }
  }

  /// One segment for each stretch of one material, from edge to edge of pixels.
  void append_run(const BandRun& run, const DitherBand& band, std::vector<Segment>& out) const {
    const Grid& grid = info_.plan.grid;
    const auto append = [&](std::int64_t begin, std::int64_t end, MaterialId material) {
      const double x = grid.origin.x();
      const double pitch = grid.pitch.x();
      out.push_back({x + static_cast<double>(begin) * pitch, x + static_cast<double>(end) * pitch,
                     MaterialId{plain_.ids[material.value()]}, run.solid});
    };
    if (run.materials.size() < 2) {
      append(run.pixels.begin, run.pixels.end, run.materials.front());
      return;
    }
    const std::span<const std::uint8_t> chosen = band.chosen(run.number);
    for (std::size_t n = 0; n < chosen.size();) {
      const std::size_t begin = n;
      while (n < chosen.size() && chosen[n] == chosen[begin]) ++n;
      append(run.pixels.begin + static_cast<std::int64_t>(begin), run.pixels.begin + static_cast<std::int64_t>(n),
             run.materials[chosen[begin]]);
    }
  }

  [[nodiscard]] SliceReport plain_report(const SliceReport& report) const {
    SliceReport plain = report;
    plain.materials = {};
    for (const MaterialId id : info_.materials.ids()) {
      if (!info_.materials[id].is_graded()) plain.materials.push_back(report.materials[id]);
    }
    return plain;
  }

  std::unique_ptr<LayerSink> inner_;
  BuildInfo info_;
  PlainBuild plain_;
  std::optional<DitherMask> mask_;
};

}  // namespace

std::unique_ptr<LayerSink> make_dither_sink(std::unique_ptr<LayerSink> inner) {
  return std::make_unique<DitherSink>(std::move(inner));
}

}  // namespace lamella
