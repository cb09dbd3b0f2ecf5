#include "export/vdb/grid_set.h"

#include <algorithm>
#include <mutex>
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/TopologyToLevelSet.h>

namespace lamella {

namespace {

constexpr const char* kCreator = "Lamella";
constexpr std::string_view kMaskPrefix = "density_";
constexpr int kBandVoxels = 3;  // of a level set on either side of its surface, as other programs expect

void initialise_library() {
  static std::once_flag done;
  std::call_once(done, [] { openvdb::initialize(); });
}

/// Gives access to the writing of an archive to any stream, so that failures of ours are seen; openvdb::io::File opens
/// its stream itself and does not look at it after the last write.
class StreamArchive final : public openvdb::io::Archive {
 public:
  void write_to(std::ostream& stream, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) const {
    Archive::write(stream, grids, true, metadata);
  }
};

/// A grid under construction: runs arrive as tiles and whole leaves, never as single voxels.
template <class GridT>
class GridBuilder {
 public:
  using Value = typename GridT::ValueType;

  explicit GridBuilder(const std::string& name) : grid_(GridT::create(Value(0))), accessor_(grid_->tree()) {
    grid_->setName(name);
    grid_->setCreator(kCreator);
    grid_->insertMeta("unit", openvdb::StringMetadata("mm"));
  }

  void add_tile(const openvdb::Coord& corner, Value value) {
    accessor_.addTile(1, corner, value, true);  // level 1: one entry of the leaves' parent
  }

  /// A leaf whose voxels have `value_of(label)`, active where that isn't 0; a tile if they are all equal.
  template <class ValueOf>
  void add_leaf(const openvdb::Coord& corner, const LeafLabels& labels, ValueOf value_of) {
    std::array<Value, 512> values;
    bool uniform = true;
    for (std::size_t n = 0; n < 512; ++n) {
      values[n] = value_of(labels[n]);
      uniform &= values[n] == values[0];
    }
    if (uniform) {
      if (values[0] != Value(0)) add_tile(corner, values[0]);
      return;
    }
    typename GridT::TreeType::LeafNodeType::NodeMaskType active;
    for (openvdb::Index32 word = 0; word < 8; ++word) {
      std::uint64_t bits = 0;
      for (std::size_t n = 0; n < 64; ++n) bits |= std::uint64_t{values[64 * word + n] != Value(0)} << n;
      active.template getWord<openvdb::Index64>(word) = bits;
    }
    auto* leaf = accessor_.touchLeaf(corner);
    std::copy(values.begin(), values.end(), leaf->buffer().data());
    leaf->setValueMask(active);
  }

  void set(const openvdb::Coord& voxel, Value value) { accessor_.setValueOn(voxel, value); }

  [[nodiscard]] const typename GridT::Ptr& grid() const { return grid_; }

 private:
  typename GridT::Ptr grid_;
  openvdb::tree::ValueAccessor<typename GridT::TreeType> accessor_;
};

using FloatBuilder = GridBuilder<openvdb::FloatGrid>;
using IntBuilder = GridBuilder<openvdb::Int32Grid>;

openvdb::Coord to_coord(const GridSet::Coord& place) { return {place[0], place[1], place[2]}; }

class OpenVdbGridSet final : public GridSet {
 public:
  explicit OpenVdbGridSet(const GridSetSpec& spec) : spec_(spec), transform_(make_transform(spec)) {
    if (spec.options.density) density_.emplace("density");
    if (spec.options.labels) material_.emplace("material");
    for (const VdbMaterial& material : spec.materials) {
      masks_.emplace_back(std::string(kMaskPrefix) + material.file_name);
    }
    if (spec.options.integer_ids) ids_.emplace("material_id");
    describe();
  }

  void add_uniform(const Coord& place, std::uint32_t label) override {
    const openvdb::Coord corner = to_coord(place);
    if (density_) density_->add_tile(corner, 1.0f);
    if (needs_masks()) masks_[label - 1].add_tile(corner, 1.0f);
    if (material_) material_->add_tile(corner, static_cast<float>(label));
    if (ids_) ids_->add_tile(corner, static_cast<std::int32_t>(label));
  }

  void add_mixed(const Coord& place, const LeafLabels& labels) override {
    const openvdb::Coord corner = to_coord(place);
    if (density_) density_->add_leaf(corner, labels, [](std::uint32_t label) { return label != 0 ? 1.0f : 0.0f; });
    if (material_) material_->add_leaf(corner, labels, [](std::uint32_t label) { return static_cast<float>(label); });
    if (ids_) ids_->add_leaf(corner, labels, [](std::uint32_t label) { return static_cast<std::int32_t>(label); });
    if (!needs_masks()) return;
    for (const std::uint32_t label : distinct(labels)) {
      masks_[label - 1].add_leaf(corner, labels, [&](std::uint32_t l) { return l == label ? 1.0f : 0.0f; });
    }
  }

  void add_fractions(const Coord& first, const MixedRun& run) override {
    if (!needs_masks()) return;
    const auto count = static_cast<std::size_t>(run.pixels.end - run.pixels.begin);
    for (std::size_t c = 0; c < run.materials.size(); ++c) {
      FloatBuilder& mask = masks_[run.materials[c].value()];
      for (std::size_t n = 0; n < count; ++n) {
        const float fraction = run.fractions[c * count + n];
        if (fraction > 0.0F) mask.set(to_coord(first).offsetBy(static_cast<int>(n), 0, 0), fraction);
      }
    }
  }

  void write(std::ostream& stream) override {
    openvdb::MetaMap metadata;
    metadata.insertMeta("creator", openvdb::StringMetadata(kCreator));
    metadata.insertMeta("unit", openvdb::StringMetadata("mm"));
    insert_names(metadata);
    StreamArchive().write_to(stream, finish(), metadata);
  }

 private:
  /// The grids in the order of the file.
  [[nodiscard]] openvdb::GridCPtrVec finish() {
    openvdb::GridCPtrVec grids;
    const auto add = [&](auto& builder) {
      openvdb::tools::prune(builder.grid()->tree());
      grids.push_back(builder.grid());
    };
    if (density_) add(*density_);
    if (material_) add(*material_);
    if (spec_.options.fog) {
      for (FloatBuilder& mask : masks_) add(mask);
    }
    if (ids_) add(*ids_);
    if (spec_.options.signed_distance) {
      for (FloatBuilder& mask : masks_) grids.push_back(distance_to(*mask.grid()));
    }
    return grids;
  }

  /// Level sets are made of the masks.
  [[nodiscard]] bool needs_masks() const { return spec_.options.fog || spec_.options.signed_distance; }

  /// Distance in mm to the surface between voxels of a material and others, negative within it, in a narrow band.
  static openvdb::FloatGrid::Ptr distance_to(const openvdb::FloatGrid& mask) {
    constexpr int kClosingSteps = 0;  // a gap of one voxel is a gap
    auto surface = openvdb::tools::topologyToLevelSet(mask, kBandVoxels, kClosingSteps);
    for (auto meta = mask.beginMeta(); meta != mask.endMeta(); ++meta) surface->insertMeta(meta->first, *meta->second);
    surface->setGridClass(openvdb::GRID_LEVEL_SET);
    surface->setName("surface_" + mask.getName().substr(kMaskPrefix.size()));
    return surface;
  }

  /// The materials' labels among those of a leaf, few as a rule.
  const std::vector<std::uint32_t>& distinct(const LeafLabels& labels) {
    distinct_.clear();
    std::uint32_t last = 0;
    for (const std::uint32_t label : labels) {
      if (label == last || label == 0) continue;
      last = label;
      if (std::find(distinct_.begin(), distinct_.end(), label) == distinct_.end()) distinct_.push_back(label);
    }
    std::sort(distinct_.begin(), distinct_.end());
    return distinct_;
  }

  /// Index (i, j, k) goes to the centre of its voxel in mm (command.md, raster lattice).
  static openvdb::math::Transform::Ptr make_transform(const GridSetSpec& spec) {
    return std::make_shared<openvdb::math::Transform>(openvdb::math::MapBase::Ptr(new openvdb::math::ScaleTranslateMap(
        {spec.pitch.x(), spec.pitch.y(), spec.pitch.z()}, {spec.centre.x(), spec.centre.y(), spec.centre.z()})));
  }

  void describe() {
    if (density_) {
      density_->grid()->setGridClass(openvdb::GRID_FOG_VOLUME);
      describe_names(*density_->grid());
    }
    if (material_) describe_names(*material_->grid());
    if (ids_) describe_names(*ids_->grid());
    for (std::size_t i = 0; i < masks_.size(); ++i) {
      openvdb::FloatGrid& mask = *masks_[i].grid();
      mask.setGridClass(openvdb::GRID_FOG_VOLUME);
      mask.setTransform(transform_->copy());
      const VdbMaterial& material = spec_.materials[i];
      mask.insertMeta("material_id", openvdb::Int32Metadata(static_cast<std::int32_t>(1 + i)));
      mask.insertMeta("material_name", openvdb::StringMetadata(material.name));
      mask.insertMeta("color", openvdb::Vec3SMetadata(openvdb::Vec3s(material.color.data())));
      if (material.density) mask.insertMeta("density_g_cm3", openvdb::DoubleMetadata(*material.density));
    }
  }

  void describe_names(openvdb::GridBase& grid) const {
    grid.setTransform(transform_->copy());
    insert_names(grid);
  }

  /// The table of labels: `material_1` is the name of the material with label 1, and so on.
  void insert_names(openvdb::MetaMap& metadata) const {
    for (std::size_t i = 0; i < spec_.materials.size(); ++i) {
      metadata.insertMeta("material_" + std::to_string(1 + i), openvdb::StringMetadata(spec_.materials[i].name));
    }
    if (!spec_.rotation.empty()) metadata.insertMeta("rotation", openvdb::StringMetadata(spec_.rotation));
  }

  GridSetSpec spec_;
  openvdb::math::Transform::Ptr transform_;
  std::optional<FloatBuilder> density_;
  std::optional<FloatBuilder> material_;
  std::vector<FloatBuilder> masks_;  ///< by material
  std::optional<IntBuilder> ids_;
  std::vector<std::uint32_t> distinct_;  ///< memory of distinct()
};

}  // namespace

extern "C" GridSet* lamella_make_grid_set(const GridSetSpec& spec) {
  initialise_library();
  return new OpenVdbGridSet(spec);
}
static_assert(std::is_same_v<decltype(lamella_make_grid_set), MakeGridSet>);

}  // namespace lamella
