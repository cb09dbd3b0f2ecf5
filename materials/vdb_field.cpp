#include "materials/vdb_field.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <mutex>
#include <new>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <stdexcept>
#include <utility>

#include "core/error.h"

namespace lamella {

namespace {

using Grids = std::vector<openvdb::FloatGrid::ConstPtr>;

/// A file is read whole.
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{4} << 30;

void initialise_library() {
  static std::once_flag done;
  std::call_once(done, [] { openvdb::initialize(); });
}

std::string names_of(const openvdb::GridPtrVec& grids) {
  std::string names;
  for (const auto& grid : grids) names += (names.empty() ? "'" : ", '") + grid->getName() + "'";
  return names.empty() ? "it has no grids" : "its grids are " + names;
}

openvdb::FloatGrid::ConstPtr find_grid(const openvdb::GridPtrVec& grids, const std::string& name,
                                       const std::string& file) {
  const auto found =
      std::find_if(grids.begin(), grids.end(), [&](const auto& grid) { return grid->getName() == name; });
  if (found == grids.end()) throw InputError("no grid '" + name + "'", file, names_of(grids));
  const auto grid = openvdb::gridConstPtrCast<openvdb::FloatGrid>(*found);
  if (!grid) throw InputError("grid '" + name + "' isn't one of floats", file, "store it as a FloatGrid");
  return grid;
}

/// OpenVDB doesn't look whether what it reads is there, and takes what isn't for sizes; so the stream throws.
openvdb::GridPtrVec read_all(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  const auto grids = openvdb::io::Stream(stream, false).getGrids();
  return grids ? *grids : openvdb::GridPtrVec();
}

Grids read_grids(const std::filesystem::path& path, const std::vector<std::string>& names, const std::string& where) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure)) {
    throw InputError("can't read the grid file", path.string(), "named at " + where + "; relative to that file");
  }
  if (std::filesystem::file_size(path, failure) > kMaxBytes || failure) {
    throw InputError("a grid file of more than 4 GiB", path.string(), "use fewer voxels");
  }
  initialise_library();
  const auto refuse = [&](const std::string& why) {
    return InputError("not an OpenVDB file that can be read: " + why, path.string(), "named at " + where);
  };
  try {
    const openvdb::GridPtrVec all = read_all(path);
    Grids grids;
    for (const std::string& name : names) grids.push_back(find_grid(all, name, path.string()));
    return grids;
  } catch (const openvdb::Exception& error) {
    throw refuse(error.what());
  } catch (const std::ios::failure&) {
    throw refuse("it ends too early");
  } catch (const std::bad_alloc&) {
    throw refuse("it takes more memory than there is");
  } catch (const std::length_error&) {
    throw refuse("it is damaged");
  }
}

class VdbProbe final : public FieldProbe {
 public:
  explicit VdbProbe(const Grids& grids) {
    samplers_.reserve(grids.size());
    for (const auto& grid : grids) samplers_.push_back(std::make_unique<Sampler>(*grid));
  }
  double sample(const Vec3& point, std::span<double> fractions) override {
    const openvdb::Vec3d there(point.x(), point.y(), point.z());
    double rest = 1.0;
    for (std::size_t i = 0; i < samplers_.size(); ++i) {
      fractions[i] = trilinear(*samplers_[i], there);
      rest -= fractions[i];
    }
    if (samplers_.size() < fractions.size()) fractions.back() = rest;
    return repair_fractions(fractions);
  }

 private:
  struct Sampler {
    explicit Sampler(const openvdb::FloatGrid& grid) : transform(grid.transform()), accessor(grid.getConstAccessor()) {}
    const openvdb::math::Transform& transform;
    openvdb::FloatGrid::ConstAccessor accessor;
  };

  /// In double precision, which OpenVDB's own sampler has not.
  static double trilinear(Sampler& sampler, const openvdb::Vec3d& point) {
    const openvdb::Vec3d index = sampler.transform.worldToIndex(point);
    // Beyond the range of an index there is nothing, and NaN is nowhere.
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::abs(index[axis]) < 1e9)) return sampler.accessor.tree().background();
    }
    const openvdb::Coord corner = openvdb::Coord::floor(index);
    const openvdb::Vec3d part = index - corner.asVec3d();
    double sum = 0.0;
    for (int n = 0; n < 8; ++n) {
      const openvdb::Coord step(n & 1, (n >> 1) & 1, n >> 2);
      double weight = 1.0;
      for (int axis = 0; axis < 3; ++axis) weight *= step[axis] != 0 ? part[axis] : 1.0 - part[axis];
      sum += weight * sampler.accessor.getValue(corner + step);
    }
    return sum;
  }

  std::vector<std::unique_ptr<Sampler>> samplers_;
};

class VdbField final : public Field {
 public:
  explicit VdbField(Grids grids) : grids_(std::move(grids)) {}
  [[nodiscard]] std::unique_ptr<FieldProbe> probe() const override { return std::make_unique<VdbProbe>(grids_); }
  /// A voxel.
  [[nodiscard]] double detail() const override {
    double least = 0.0;
    for (const auto& grid : grids_) {
      const openvdb::Vec3d size = grid->voxelSize();
      const double smallest = std::min({size.x(), size.y(), size.z()});
      least = least == 0.0 ? smallest : std::min(least, smallest);
    }
    return least;
  }

 private:
  Grids grids_;
};

class VdbSource final : public FieldSource {
 public:
  VdbSource(std::shared_ptr<const Field> field, std::filesystem::path file, std::vector<std::string> grids)
      : field_(std::move(field)), file_(std::move(file)), grids_(std::move(grids)) {}
  [[nodiscard]] std::shared_ptr<const Field> bind(const Scene&, SolidId) const override { return field_; }
  [[nodiscard]] std::string element(const std::string& indent, const std::filesystem::path& beside) const override {
    const std::filesystem::path file = std::filesystem::proximate(std::filesystem::absolute(file_), beside);
    std::string lines = indent + "<grid" + attribute_text("file", file.string()) + ">\n";
    for (const std::string& grid : grids_) lines += indent + "  <fraction" + attribute_text("grid", grid) + "/>\n";
    return lines + indent + "</grid>\n";
  }

 private:
  std::shared_ptr<const Field> field_;
  std::filesystem::path file_;
  std::vector<std::string> grids_;
};

}  // namespace

std::shared_ptr<const FieldSource> make_vdb_field(const std::filesystem::path& file,
                                                  const std::vector<std::string>& grids, std::size_t components,
                                                  const std::string& where) {
  if (grids.empty() || (grids.size() != components && grids.size() + 1 != components)) {
    throw InputError(std::to_string(grids.size()) + " grids for " + std::to_string(components) + " components", where,
                     "give one for each component, or one less: the last component is what is left");
  }
  return std::make_shared<VdbSource>(std::make_shared<VdbField>(read_grids(file, grids, where)), file, grids);
}

}  // namespace lamella
