#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "export/raster_row.h"
#include "slicing/layer_sink.h"

namespace lamella {

/// Which pixels of a row belong to a segment.
enum class PixelChoice : std::uint8_t {
  centre,   ///< whose centres it holds
  touched,  ///< that it covers in part or wholly
};

/// Pixels of one segment and what they consist of.
struct MixedRun {
  PixelRun pixels;
  SolidId solid;
  MaterialId material;  ///< of the segment
  double x_begin;       ///< of the segment, mm
  double x_end;
  std::span<const MaterialId> materials;  ///< the components, or the one material of a segment that isn't graded
  std::span<const float> fractions;  ///< at the pixels' centres: those of the first material, then of the second ...
};

/// Reads what the pixels of raster rows consist of; memory is used again from row to row, by one thread.
class MixedRowReader {
 public:
  /// The build must outlive it.
  explicit MixedRowReader(const BuildInfo& info, PixelChoice choice = PixelChoice::centre)
      : info_(info), raster_(info.plan.grid), choice_(choice) {}

  /// Calls visit for each segment of a row that holds pixels. What a run refers to is valid during the call.
  void read(const SegmentRows& rows, std::size_t row, const std::function<void(const MixedRun&)>& visit);

 private:
  void sample(const Mixtures& mixtures, std::size_t g, const PixelRun& pixels, std::size_t components);

  const BuildInfo& info_;
  RowRaster raster_;
  PixelChoice choice_;
  std::vector<float> fractions_;
};

/// A build as outputs see it that know plain materials only.
struct PlainBuild {
  BuildInfo info;  ///< without graded materials and without a hatch; solids of graded material have its first component
  std::vector<std::size_t> ids;  ///< of each plain material of the build by its id; of graded ones no meaning
};
[[nodiscard]] PlainBuild plain_build(const BuildInfo& info);

}  // namespace lamella
