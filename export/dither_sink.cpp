#include "export/dither_sink.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.h"
#include "export/build_check.h"
#include "export/mixed_row.h"
#include "slicing/dither.h"

namespace lamella {

namespace {

/// dither_row() tells no more materials apart.
constexpr std::size_t kMaxComponents = 256;

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
    std::vector<std::uint8_t> chosen;
    for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
      reader.read(layer.raster, row, [&](const MixedRun& run) {
        chosen.assign(static_cast<std::size_t>(run.pixels.end - run.pixels.begin), 0);
        if (run.materials.size() > 1) {
          const VoxelIndex first{run.pixels.begin, static_cast<std::int64_t>(row), layer.index};
          dither_row(*mask_, first, run.fractions, chosen);
        }
        append(run, chosen, out.raster.segments);
      });
      out.raster.row_start.push_back(out.raster.segments.size());
    }
    return out;
  }

  /// One segment for each stretch of one material, from edge to edge of pixels.
  void append(const MixedRun& run, const std::vector<std::uint8_t>& chosen, std::vector<Segment>& out) const {
    const Grid& grid = info_.plan.grid;
    const auto edge = [&](std::size_t n) {
      return grid.origin.x() + static_cast<double>(run.pixels.begin + static_cast<std::int64_t>(n)) * grid.pitch.x();
    };
    for (std::size_t n = 0; n < chosen.size();) {
      const std::size_t begin = n;
      while (n < chosen.size() && chosen[n] == chosen[begin]) ++n;
      const MaterialId material{plain_.ids[run.materials[chosen[begin]].value()]};
      out.push_back({edge(begin), edge(n), material, run.solid});
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
