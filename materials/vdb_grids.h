#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry.h"

/// Between the library and the shared object that reads OpenVDB files: OpenVDB is loaded when a file is to be read,
/// since binding its symbols takes longer than all else that a command does before it begins
/// (docs/decisions/0012-openvdb-when-needed.md).
namespace lamella {

/// Trilinear between the values of a grid of floats, in double precision. For one thread.
class VdbProbe {
 public:
  virtual ~VdbProbe() = default;
  /// At a point in mm, in the frame of the grid's own transform; the background beyond the grid and at NaN.
  [[nodiscard]] virtual double sample(const Vec3& point) = 0;
};

/// One grid of a file.
class VdbGrid {
 public:
  virtual ~VdbGrid() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// Only grids of floats can be probed.
  [[nodiscard]] virtual bool holds_floats() const = 0;
  /// The shortest side of a voxel, mm.
  [[nodiscard]] virtual double voxel_side() const = 0;
  [[nodiscard]] virtual std::unique_ptr<VdbProbe> probe() const = 0;
};

using VdbGrids = std::vector<std::shared_ptr<const VdbGrid>>;

/// All grids of a file, in its order. Throws std::runtime_error that says why the file can't be read.
using ReadVdbGrids = void(const std::filesystem::path& path, VdbGrids& grids);
inline constexpr const char* kVdbReaderObject = "liblamella_vdb_reader.so";
inline constexpr const char* kReadVdbGrids = "lamella_read_vdb_grids";

}  // namespace lamella
