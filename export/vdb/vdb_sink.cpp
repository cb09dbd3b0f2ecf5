#include "export/vdb/vdb_sink.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/TopologyToLevelSet.h>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/sha256.h"
#include "core/utf8.h"
#include "export/build_check.h"
#include "export/file_name.h"
#include "export/mixed_row.h"
#include "export/output_file.h"
#include "export/uniform_z.h"
#include "export/vdb/slab.h"
#include "slicing/rotation_words.h"

namespace lamella {

namespace {

constexpr std::int64_t kMaxVoxelsPerAxis = std::int64_t{1} << 20;
constexpr const char* kCreator = "Lamella";
constexpr std::string_view kMaskPrefix = "density_";
constexpr int kBandVoxels = 3;   // of a level set on either side of its surface, as other programs expect
constexpr double kCubic = 1e-6;  // how much the sides of a voxel may differ in a level set

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

/// `text` as UTF-8 without zero bytes; readers refuse other metadata.
std::string clean_text(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint c = decode_utf8(text, at);
    const bool keep = c.length != 0 && c.value != 0;
    out += keep ? text.substr(at, c.length) : std::string("\xEF\xBF\xBD");
    at += std::max<std::size_t>(c.length, 1);
  }
  return out;
}

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

/// All grids of one build.
class GridSet {
 public:
  GridSet(const BuildInfo& info, const Grid& grid, const VdbOptions& options)
      : transform_(make_transform(grid)), has_fog_(options.fog), signed_distance_(options.signed_distance) {
    if (options.density) density_.emplace("density");
    if (options.labels) material_.emplace("material");
    std::vector<std::string> names;
    for (const Material& material : info.materials) names.push_back(material.name);
    for (const std::string& name : safe_file_names(names)) masks_.emplace_back(std::string(kMaskPrefix) + name);
    if (options.integer_ids) ids_.emplace("material_id");
    describe(info);
  }

  void add_uniform(const openvdb::Coord& corner, std::uint32_t label) {
    if (density_) density_->add_tile(corner, 1.0f);
    if (needs_masks()) masks_[label - 1].add_tile(corner, 1.0f);
    if (material_) material_->add_tile(corner, static_cast<float>(label));
    if (ids_) ids_->add_tile(corner, static_cast<std::int32_t>(label));
  }

  void add_mixed(const openvdb::Coord& corner, const LeafLabels& labels) {
    if (density_) density_->add_leaf(corner, labels, [](std::uint32_t label) { return label != 0 ? 1.0f : 0.0f; });
    if (material_) material_->add_leaf(corner, labels, [](std::uint32_t label) { return static_cast<float>(label); });
    if (ids_) ids_->add_leaf(corner, labels, [](std::uint32_t label) { return static_cast<std::int32_t>(label); });
    if (!needs_masks()) return;
    for (const std::uint32_t label : distinct(labels)) {
      masks_[label - 1].add_leaf(corner, labels, [&](std::uint32_t l) { return l == label ? 1.0f : 0.0f; });
    }
  }

  /// Sets the fractions of graded voxels; the leaves that they lie in must have been added.
  void add_fractions(const openvdb::Coord& first, const MixedRun& run) {
    if (!needs_masks()) return;
    const auto count = static_cast<std::size_t>(run.pixels.end - run.pixels.begin);
    for (std::size_t c = 0; c < run.materials.size(); ++c) {
      FloatBuilder& mask = masks_[run.materials[c].value()];
      for (std::size_t n = 0; n < count; ++n) {
        const float fraction = run.fractions[c * count + n];
        if (fraction > 0.0F) mask.set(first.offsetBy(static_cast<int>(n), 0, 0), fraction);
      }
    }
  }

  /// Merges equal neighbours into larger tiles and returns the grids in the order of the file.
  [[nodiscard]] openvdb::GridCPtrVec finish() {
    openvdb::GridCPtrVec grids;
    const auto add = [&](auto& builder) {
      openvdb::tools::prune(builder.grid()->tree());
      grids.push_back(builder.grid());
    };
    if (density_) add(*density_);
    if (material_) add(*material_);
    if (has_fog_) {
      for (FloatBuilder& mask : masks_) add(mask);
    }
    if (ids_) add(*ids_);
    if (signed_distance_) {
      for (FloatBuilder& mask : masks_) grids.push_back(distance_to(*mask.grid()));
    }
    return grids;
  }

 private:
  /// Level sets are made of the masks.
  [[nodiscard]] bool needs_masks() const { return has_fog_ || signed_distance_; }

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
  static openvdb::math::Transform::Ptr make_transform(const Grid& grid) {
    const Vec3 centre = grid.origin + 0.5 * grid.pitch;
    return std::make_shared<openvdb::math::Transform>(openvdb::math::MapBase::Ptr(new openvdb::math::ScaleTranslateMap(
        {grid.pitch.x(), grid.pitch.y(), grid.pitch.z()}, {centre.x(), centre.y(), centre.z()})));
  }

  void describe(const BuildInfo& info) {
    if (density_) {
      density_->grid()->setGridClass(openvdb::GRID_FOG_VOLUME);
      describe_names(*density_->grid(), info);
    }
    if (material_) describe_names(*material_->grid(), info);
    if (ids_) describe_names(*ids_->grid(), info);
    for (MaterialId id : info.materials.ids()) {
      openvdb::FloatGrid& mask = *masks_[id.value()].grid();
      mask.setGridClass(openvdb::GRID_FOG_VOLUME);
      mask.setTransform(transform_->copy());
      const Material& material = info.materials[id];
      mask.insertMeta("material_id", openvdb::Int32Metadata(static_cast<std::int32_t>(1 + id.value())));
      mask.insertMeta("material_name", openvdb::StringMetadata(clean_text(material.name)));
      const openvdb::Vec3s color(static_cast<float>(material.color[0]), static_cast<float>(material.color[1]),
                                 static_cast<float>(material.color[2]));
      mask.insertMeta("color", openvdb::Vec3SMetadata(color));
      if (material.density) mask.insertMeta("density_g_cm3", openvdb::DoubleMetadata(*material.density));
    }
  }

  void describe_names(openvdb::GridBase& grid, const BuildInfo& info) const {
    grid.setTransform(transform_->copy());
    insert_names(grid, info);
  }

 public:
  /// The table of labels: `material_1` is the name of the material with label 1, and so on. `rotation`: how the
  /// assembly was turned, if it was.
  static void insert_names(openvdb::MetaMap& metadata, const BuildInfo& info) {
    for (MaterialId id : info.materials.ids()) {
      metadata.insertMeta("material_" + std::to_string(1 + id.value()),
                          openvdb::StringMetadata(clean_text(info.materials[id].name)));
    }
    if (info.turn) metadata.insertMeta("rotation", openvdb::StringMetadata(rotation_text(*info.turn)));
  }

 private:
  openvdb::math::Transform::Ptr transform_;
  bool has_fog_;
  bool signed_distance_;
  std::optional<FloatBuilder> density_;
  std::optional<FloatBuilder> material_;
  std::vector<FloatBuilder> masks_;  ///< by material
  std::optional<IntBuilder> ids_;
  std::vector<std::uint32_t> distinct_;  ///< memory of distinct()
};

/// Writes `digest` in the place of the random UUID that OpenVDB puts into a file's header, so that the same build gives
/// the same bytes. The UUID only tells files apart; version 8 (RFC 9562) leaves its contents to the maker.
void set_file_id(std::ostream& stream, const std::string& digest) {
  constexpr std::streamoff kPlace = 8 + 4 + 4 + 4 + 1;  // magic, file version, library version, offsets flag
  std::string id = digest.substr(0, 8) + "-" + digest.substr(8, 4) + "-8" + digest.substr(13, 3) + "-8" +
                   digest.substr(17, 3) + "-" + digest.substr(20, 12);
  stream.seekp(kPlace);
  stream.write(id.data(), static_cast<std::streamsize>(id.size()));
}

class VdbSink final : public LayerSink {
 public:
  VdbSink(std::filesystem::path path, const VdbOptions& options) : path_(std::move(path)), options_(options) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    uniform_.emplace(info.plan, options_.z_pitch, "a VDB");
    Grid grid = info.plan.grid;
    grid.origin.z() = uniform_->bottom();
    grid.pitch.z() = uniform_->pitch();
    grid.size[2] = uniform_->count();
    for (std::int64_t size : grid.size) {
      if (size > kMaxVoxelsPerAxis) {
        throw UsageError("a VDB takes at most 2^20 voxels along an axis", path_.string(), "choose a coarser --pitch");
      }
    }
    if (options_.signed_distance && grid.pitch.maxCoeff() > (1.0 + kCubic) * grid.pitch.minCoeff()) {
      throw UsageError("signed distances need cubic voxels", "--vdb-sdf",
                       "slice with the same --pitch and --layer-height, or give --z-pitch");
    }
    initialise_library();
    info_ = info;
    file_.emplace(path_);
    grids_.emplace(info, grid, options_);
    slab_.emplace(grid);
    for (const Material& material : info.materials) digest_.update(std::as_bytes(std::span(material.name)));
  }

  void write(const Layer& layer) override {
    check_layer(layer, info_);
    if (last_ && layer.index <= *last_) throw ExportError("layers are not in order", path_.string());
    last_ = layer.index;
    const SliceRange slices = uniform_->slices(layer.index);
    for (std::int64_t slice = slices.begin; slice < slices.end; ++slice) {
      const std::int64_t slab = slice / kLeafSide;
      if (slab != slab_->index()) flush(slab);
      slab_->add(layer, slice);
      if (!layer.raster.mixtures.empty()) mixed_.push_back({slice, layer});
    }
    add_to_digest(layer);
  }

  void finish(const SliceReport&) override {
    flush(0);
    const openvdb::GridCPtrVec grids = grids_->finish();
    openvdb::MetaMap metadata;
    metadata.insertMeta("creator", openvdb::StringMetadata(kCreator));
    metadata.insertMeta("unit", openvdb::StringMetadata("mm"));
    GridSet::insert_names(metadata, info_);
    try {
      StreamArchive().write_to(file_->stream(), grids, metadata);
    } catch (const std::exception& error) {
      throw ExportError(std::string("can't write VDB: ") + error.what(), path_.string());
    }
    set_file_id(file_->stream(), digest_.finish());
    file_->commit();
  }

 private:
  /// Hands the slab's leaves to the grids and begins another slab.
  void flush(std::int64_t next) {
    const std::int64_t z = slab_->index() * kLeafSide;
    const auto corner = [&](std::int64_t i, std::int64_t j) {
      return openvdb::Coord(static_cast<int>(i * kLeafSide), static_cast<int>(j * kLeafSide), static_cast<int>(z));
    };
    slab_->visit({[&](auto i, auto j, std::uint32_t label) { grids_->add_uniform(corner(i, j), label); },
                  [&](auto i, auto j, const LeafLabels& labels) { grids_->add_mixed(corner(i, j), labels); }});
    add_mixed_layers();
    slab_->reset(next);
  }

  /// Fractions go over the leaves that the slab's labels made.
  void add_mixed_layers() {
    MixedRowReader reader(info_);
    for (const auto& [slice, layer] : mixed_) {
      for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
        reader.read(layer.raster, row, [&](const MixedRun& run) {
          if (run.materials.size() < 2) return;
          const openvdb::Coord first(static_cast<int>(run.pixels.begin), static_cast<int>(row),
                                     static_cast<int>(slice));
          grids_->add_fractions(first, run);
        });
      }
    }
    mixed_.clear();
  }

  void add_to_digest(const Layer& layer) {
    digest_.update(std::as_bytes(std::span(&layer.index, 1)));
    digest_.update(std::as_bytes(std::span(layer.raster.row_start)));
    digest_.update(std::as_bytes(std::span(layer.raster.segments)));
    digest_.update(std::as_bytes(std::span(layer.raster.mixtures.x)));
    digest_.update(std::as_bytes(std::span(layer.raster.mixtures.fraction)));
  }

  std::filesystem::path path_;
  VdbOptions options_;
  BuildInfo info_;
  std::optional<OutputFile> file_;
  std::optional<GridSet> grids_;
  std::optional<Slab> slab_;
  std::optional<UniformZ> uniform_;
  std::vector<std::pair<std::int64_t, Layer>> mixed_;  ///< slices of the slab with graded segments
  std::optional<std::uint32_t> last_;
  Sha256 digest_;
};

}  // namespace

std::unique_ptr<LayerSink> make_vdb_sink(const std::filesystem::path& file, const VdbOptions& options) {
  return std::make_unique<VdbSink>(file, options);
}

}  // namespace lamella
