#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "slicing/layer_sink.h"

namespace lamella {

/// The voxels of a volume of labels: 0 is void, 1 + id a material; x fastest, j ascending with y, k with z.
struct Volume {
  Vec3 origin = Vec3::Zero();          ///< lower corner of voxel (0, 0, 0), mm
  Vec3 pitch = Vec3::Ones();           ///< mm
  std::array<std::int64_t, 3> size{};  ///< voxels along x, y, z
  int label_bytes = 1;                 ///< 1 or 2, little-endian

  [[nodiscard]] Vec3 first_centre() const { return origin + 0.5 * pitch; }
  [[nodiscard]] std::size_t row_bytes() const { return static_cast<std::size_t>(size[0] * label_bytes); }
  [[nodiscard]] std::size_t slice_bytes() const { return row_bytes() * static_cast<std::size_t>(size[1]); }
};

/// One slice as a file holds it.
struct EncodedSlice {
  std::string bytes;
  std::uint32_t checksum = 0;  ///< of the labels, where the format has one
};

/// Writes a volume slice by slice. How many slices come, and from which z on, is known only at the end.
class VolumeFile {
 public:
  virtual ~VolumeFile() = default;
  /// `volume` has all slices of the plan. Throws ExportError when the target can't be written.
  virtual void begin(const BuildInfo& info, const Volume& volume) = 0;
  /// Called from several threads at once, after begin().
  [[nodiscard]] virtual EncodedSlice encode(std::span<const std::uint8_t> labels) const = 0;
  /// Appends a slice, in increasing z.
  virtual void add(const EncodedSlice& slice) = 0;
  /// `volume` has the slices that were added, at least one.
  virtual void finish(const Volume& volume) = 0;
};

struct VolumeOptions {
  std::optional<double> z_pitch{};  ///< mm, see UniformZ
  bool is_raw = false;              ///< not compressed
};

/// A sink that feeds `file` with the labels of pixels' centres. `format` names it in errors.
[[nodiscard]] std::unique_ptr<LayerSink> make_volume_sink(std::unique_ptr<VolumeFile> file,
                                                          const VolumeOptions& options, std::string format);

}  // namespace lamella
