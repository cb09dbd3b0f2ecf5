#include "materials/vdb_grids.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <mutex>
#include <new>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <stdexcept>

namespace lamella {

namespace {

void initialise_library() {
  static std::once_flag done;
  std::call_once(done, [] { openvdb::initialize(); });
}

/// OpenVDB doesn't look whether what it reads is there, and takes what isn't for sizes; so the stream throws.
openvdb::GridPtrVec read_all(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  const auto grids = openvdb::io::Stream(stream, false).getGrids();
  return grids ? *grids : openvdb::GridPtrVec();
}

class FloatProbe final : public VdbProbe {
 public:
  explicit FloatProbe(const openvdb::FloatGrid& grid)
      : transform_(grid.transform()), accessor_(grid.getConstAccessor()) {}

  /// In double precision, which OpenVDB's own sampler has not.
  double sample(const Vec3& at) override {
    const openvdb::Vec3d index = transform_.worldToIndex(openvdb::Vec3d(at.x(), at.y(), at.z()));
    // Beyond the range of an index there is nothing, and NaN is nowhere.
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::abs(index[axis]) < 1e9)) return accessor_.tree().background();
    }
    const openvdb::Coord corner = openvdb::Coord::floor(index);
    const openvdb::Vec3d part = index - corner.asVec3d();
    double sum = 0.0;
    for (int n = 0; n < 8; ++n) {
      const openvdb::Coord step(n & 1, (n >> 1) & 1, n >> 2);
      double weight = 1.0;
      for (int axis = 0; axis < 3; ++axis) weight *= step[axis] != 0 ? part[axis] : 1.0 - part[axis];
      sum += weight * accessor_.getValue(corner + step);
    }
    return sum;
  }

 private:
  const openvdb::math::Transform& transform_;
  openvdb::FloatGrid::ConstAccessor accessor_;
};

class StoredGrid final : public VdbGrid {
 public:
  explicit StoredGrid(const openvdb::GridBase::ConstPtr& grid)
      : grid_(grid), floats_(openvdb::gridConstPtrCast<openvdb::FloatGrid>(grid)) {}
  [[nodiscard]] std::string name() const override { return grid_->getName(); }
  [[nodiscard]] bool holds_floats() const override { return floats_ != nullptr; }
  [[nodiscard]] double voxel_side() const override {
    const openvdb::Vec3d size = grid_->voxelSize();
    return std::min({size.x(), size.y(), size.z()});
  }
  [[nodiscard]] std::unique_ptr<VdbProbe> probe() const override { return std::make_unique<FloatProbe>(*floats_); }

 private:
  openvdb::GridBase::ConstPtr grid_;
  openvdb::FloatGrid::ConstPtr floats_;
};

}  // namespace

extern "C" void lamella_read_vdb_grids(const std::filesystem::path& path, VdbGrids& grids) {
  initialise_library();
  try {
    for (const auto& grid : read_all(path)) grids.push_back(std::make_shared<StoredGrid>(grid));
  } catch (const openvdb::Exception& error) {
    throw std::runtime_error(error.what());
  } catch (const std::ios::failure&) {
    throw std::runtime_error("it ends too early");
  } catch (const std::bad_alloc&) {
    throw std::runtime_error("it takes more memory than there is");
  } catch (const std::length_error&) {
    throw std::runtime_error("it is damaged");
  }
}
static_assert(std::is_same_v<decltype(lamella_read_vdb_grids), ReadVdbGrids>);

}  // namespace lamella
