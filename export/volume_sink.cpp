#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "core/error.h"
#include "export/build_check.h"
#include "export/raster_row.h"
#include "export/uniform_z.h"
#include "export/volume_file.h"

namespace lamella {

namespace {

constexpr std::size_t kMaxSliceBytes = std::numeric_limits<std::int32_t>::max();

/// Labels of voxels [begin, end) of a row.
void fill_labels(std::uint8_t* row, const LabelRun& run, int label_bytes) {
  if (label_bytes == 1) {
    std::memset(row + run.begin, static_cast<int>(run.label), static_cast<std::size_t>(run.end - run.begin));
    return;
  }
  const auto label = static_cast<std::uint16_t>(run.label);
  for (std::int32_t i = run.begin; i < run.end; ++i) std::memcpy(row + 2 * static_cast<std::size_t>(i), &label, 2);
}

class VolumeSink final : public LayerSink {
 public:
  VolumeSink(std::unique_ptr<VolumeFile> file, const VolumeOptions& options, std::string format)
      : file_(std::move(file)), options_(options), format_(std::move(format)) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    if (info.materials.size() > std::numeric_limits<std::uint16_t>::max()) {
      throw UsageError("labels of 16 bits can't tell so many materials apart", format_);
    }
    info_ = info;
    uniform_.emplace(info.plan, options_.z_pitch, format_);
    volume_.origin = info.plan.grid.origin;
    volume_.origin.z() = uniform_->bottom();
    volume_.pitch = info.plan.grid.pitch;
    volume_.pitch.z() = uniform_->pitch();
    volume_.size = {info.plan.grid.size[0], info.plan.grid.size[1], std::max<std::int64_t>(uniform_->count(), 1)};
    volume_.label_bytes = info.materials.size() > std::numeric_limits<std::uint8_t>::max() ? 2 : 1;
    // No factor exceeds 2^32, so the product does not overflow.
    if (volume_.slice_bytes() > kMaxSliceBytes) {
      throw UsageError("a slice of " + std::to_string(volume_.size[0]) + " x " + std::to_string(volume_.size[1]) +
                           " voxels is too large for " + format_,
                       "", "choose a coarser --pitch");
    }
    file_->begin(info, volume_);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    const SliceRange slices = uniform_->slices(layer.index);
    if (slices.begin == slices.end) return [] {};
    auto slice = std::make_shared<const EncodedSlice>(file_->encode(labels_of(layer)));
    return [this, slice = std::move(slice), slices] { add(*slice, slices); };
  }

  void finish(const SliceReport&) override {
    if (begin_ == end_) end_ = begin_ + 1;
    if (end_ == uniform_->end()) end_ = std::max(end_, uniform_->count());  // a last slice that overhangs by half
    for (; added_ < end_ - begin_; ++added_) file_->add(blank());
    Volume written = volume_;
    written.origin.z() += static_cast<double>(begin_) * volume_.pitch.z();
    written.size[2] = end_ - begin_;
    file_->finish(written);
  }

 private:
  void add(const EncodedSlice& slice, const SliceRange& slices) {
    if (added_ == 0) begin_ = end_ = slices.begin;
    if (slices.begin != end_) throw ExportError("layers are not in order", format_);
    for (; end_ < slices.end; ++end_, ++added_) file_->add(slice);
  }

  [[nodiscard]] EncodedSlice blank() const { return file_->encode(std::vector<std::uint8_t>(volume_.slice_bytes())); }

  [[nodiscard]] std::vector<std::uint8_t> labels_of(const Layer& layer) const {
    std::vector<std::uint8_t> labels(volume_.slice_bytes());
    const RowRaster raster(info_.plan.grid);
    std::vector<LabelRun> runs;
    for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
      runs.clear();
      raster.append_runs(layer.raster.row(row), runs);
      for (const LabelRun& run : runs) {
        fill_labels(labels.data() + row * volume_.row_bytes(), run, volume_.label_bytes);
      }
    }
    return labels;
  }

  std::unique_ptr<VolumeFile> file_;
  VolumeOptions options_;
  std::string format_;
  BuildInfo info_;
  std::optional<UniformZ> uniform_;
  Volume volume_;
  std::int64_t begin_ = 0;  ///< slices [begin_, end_) were added
  std::int64_t end_ = 0;
  std::int64_t added_ = 0;
};

}  // namespace

std::unique_ptr<LayerSink> make_volume_sink(std::unique_ptr<VolumeFile> file, const VolumeOptions& options,
                                            std::string format) {
  return std::make_unique<VolumeSink>(std::move(file), options, std::move(format));
}

}  // namespace lamella
