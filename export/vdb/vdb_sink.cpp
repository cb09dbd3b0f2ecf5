#include "export/vdb/vdb_sink.h"

#include <algorithm>
#include <memory>
#include <new>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/sha256.h"
#include "core/shared_object.h"
#include "core/utf8.h"
#include "export/build_check.h"
#include "export/file_name.h"
#include "export/mixed_row.h"
#include "export/output_file.h"
#include "export/uniform_z.h"
#include "export/vdb/grid_set.h"
#include "export/vdb/slab.h"
#include "slicing/rotation_words.h"

namespace lamella {

namespace {

constexpr std::int64_t kMaxVoxelsPerAxis = std::int64_t{1} << 20;
constexpr double kCubic = 1e-6;  // how much the sides of a voxel may differ in a level set

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

GridSetSpec spec_of(const BuildInfo& info, const Grid& grid, const VdbOptions& options) {
  GridSetSpec spec{options, grid.origin + 0.5 * grid.pitch, grid.pitch, {}, {}};
  std::vector<std::string> names;
  for (const Material& material : info.materials) names.push_back(material.name);
  const std::vector<std::string> file_names = safe_file_names(names);
  for (const MaterialId id : info.materials.ids()) {
    const Material& material = info.materials[id];
    VdbMaterial& out = spec.materials.emplace_back();
    out.name = clean_text(material.name);
    out.file_name = file_names[id.value()];
    std::transform(material.color.begin(), material.color.end(), out.color.begin(),
                   [](double channel) { return static_cast<float>(channel); });
    out.density = material.density;
  }
  if (info.turn) spec.rotation = rotation_text(*info.turn);
  return spec;
}

std::unique_ptr<GridSet> make_grid_set(const GridSetSpec& spec) {
  return std::unique_ptr<GridSet>(find_function_of<MakeGridSet>(kVdbWriterObject, kMakeGridSet)(spec));
}

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
    info_ = info;
    grids_ = make_grid_set(spec_of(info, grid, options_));
    file_.emplace(path_);
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
    try {
      grids_->write(file_->stream());
    } catch (const std::bad_alloc&) {
      throw;
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
      return GridSet::Coord{static_cast<int>(i * kLeafSide), static_cast<int>(j * kLeafSide), static_cast<int>(z)};
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
          const GridSet::Coord first{static_cast<int>(run.pixels.begin), static_cast<int>(row),
                                     static_cast<int>(slice)};
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
  std::unique_ptr<GridSet> grids_;
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
