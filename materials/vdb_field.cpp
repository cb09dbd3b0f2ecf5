#include "materials/vdb_field.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "core/shared_object.h"
#include "materials/vdb_grids.h"

namespace lamella {

namespace {

/// A file is read whole.
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{4} << 30;

std::string names_of(const VdbGrids& grids) {
  std::string names;
  for (const auto& grid : grids) names += (names.empty() ? "'" : ", '") + grid->name() + "'";
  return names.empty() ? "it has no grids" : "its grids are " + names;
}

std::shared_ptr<const VdbGrid> find_grid(const VdbGrids& grids, const std::string& name, const std::string& file) {
  const auto found = std::find_if(grids.begin(), grids.end(), [&](const auto& grid) { return grid->name() == name; });
  if (found == grids.end()) throw InputError("no grid '" + name + "'", file, names_of(grids));
  if (!(*found)->holds_floats()) {
    throw InputError("grid '" + name + "' isn't one of floats", file, "store it as a FloatGrid");
  }
  return *found;
}

VdbGrids read_all(const std::filesystem::path& path, const std::string& where) {
  auto* const read = find_function_of<ReadVdbGrids>(kVdbReaderObject, kReadVdbGrids);
  VdbGrids grids;
  try {
    read(path, grids);
  } catch (const std::runtime_error& error) {
    throw InputError(std::string("not an OpenVDB file that can be read: ") + error.what(), path.string(),
                     "named at " + where);
  }
  return grids;
}

VdbGrids read_grids(const std::filesystem::path& path, const std::vector<std::string>& names,
                    const std::string& where) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure)) {
    throw InputError("can't read the grid file", path.string(), "named at " + where + "; relative to that file");
  }
  if (std::filesystem::file_size(path, failure) > kMaxBytes || failure) {
    throw InputError("a grid file of more than 4 GiB", path.string(), "use fewer voxels");
  }
  const VdbGrids all = read_all(path, where);
  VdbGrids grids;
  for (const std::string& name : names) grids.push_back(find_grid(all, name, path.string()));
  return grids;
}

class VdbFieldProbe final : public FieldProbe {
 public:
  explicit VdbFieldProbe(const VdbGrids& grids) {
    for (const auto& grid : grids) probes_.push_back(grid->probe());
  }
  double sample(const Vec3& point, std::span<double> fractions) override {
    double rest = 1.0;
    for (std::size_t i = 0; i < probes_.size(); ++i) {
      fractions[i] = probes_[i]->sample(point);
      rest -= fractions[i];
    }
    if (probes_.size() < fractions.size()) fractions.back() = rest;
    return repair_fractions(fractions);
  }

 private:
  std::vector<std::unique_ptr<VdbProbe>> probes_;
};

class VdbField final : public Field {
 public:
  explicit VdbField(VdbGrids grids) : grids_(std::move(grids)) {}
  [[nodiscard]] std::unique_ptr<FieldProbe> probe() const override { return std::make_unique<VdbFieldProbe>(grids_); }
  /// A voxel.
  [[nodiscard]] double detail() const override {
    double least = 0.0;
    for (const auto& grid : grids_) {
      const double side = grid->voxel_side();
      least = least == 0.0 ? side : std::min(least, side);
    }
    return least;
  }

 private:
  VdbGrids grids_;
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
