#pragma once

#include <array>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "export/mixed_row.h"
#include "export/vdb/slab.h"
#include "export/vdb/vdb_sink.h"

/// Between the library and the shared object that makes OpenVDB files; see materials/vdb_grids.h for why.
namespace lamella {

struct VdbMaterial {
  std::string name;  ///< UTF-8 without zero bytes
  std::string file_name;
  std::array<float, 3> color{};
  std::optional<double> density{};  ///< g/cm^3
};

/// What the grids of a file are and say.
struct GridSetSpec {
  VdbOptions options;
  Vec3 centre = Vec3::Zero();  ///< of voxel (0, 0, 0), mm
  Vec3 pitch = Vec3::Ones();   ///< mm
  std::vector<VdbMaterial> materials;
  std::string rotation;  ///< how the assembly was turned; empty if it wasn't
};

/// All grids of one file. Runs arrive as tiles and whole leaves, never as single voxels, but for fractions. Labels are
/// 1 + the material's index.
class GridSet {
 public:
  using Coord = std::array<int, 3>;

  virtual ~GridSet() = default;
  /// A leaf of one label at its lowest corner.
  virtual void add_uniform(const Coord& corner, std::uint32_t label) = 0;
  virtual void add_mixed(const Coord& corner, const LeafLabels& labels) = 0;
  /// Sets the fractions of graded voxels from the first one on; the leaves that they lie in must have been added.
  virtual void add_fractions(const Coord& first, const MixedRun& run) = 0;
  /// Merges equal neighbours into larger tiles and writes the grids. Throws std::exception.
  virtual void write(std::ostream& stream) = 0;
};

/// The new object belongs to the caller.
using MakeGridSet = GridSet*(const GridSetSpec& spec);
inline constexpr const char* kVdbWriterObject = "liblamella_vdb_writer.so";
inline constexpr const char* kMakeGridSet = "lamella_make_grid_set";

}  // namespace lamella
