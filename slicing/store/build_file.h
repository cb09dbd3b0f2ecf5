#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slicing/layer_sink.h"

namespace lamella {

/// How many of each a lattice's rows have.
struct MixtureEntry {
  std::uint64_t segments = 0;
  std::uint64_t knots = 0;
  std::uint64_t fractions = 0;
};

/// How many of each a layer's contours have.
struct ContourEntry {
  std::uint64_t loops = 0;
  std::uint64_t points = 0;
  std::uint64_t curves = 0;
};

/// Where one layer is in the store and what it must look like.
struct LayerEntry {
  std::uint64_t segments = 0;
  bool has_hatch = false;
  std::uint64_t hatch_rows = 0;
  std::uint64_t hatch_segments = 0;
  std::optional<ContourEntry> contours;
  MixtureEntry mixtures;        ///< of the raster
  MixtureEntry hatch_mixtures;  ///< of the hatch
  std::string sha256;           ///< digest_of() the layer
};

/// One file layers/NNNNNN.h5.
struct ShardEntry {
  std::string sha256;  ///< of the file's bytes
};

/// All that build.xml says (schemas/build.xsd, docs/formats/store.md).
struct BuildFile {
  BuildInfo info;
  SliceReport report;
  std::uint32_t layers_per_shard = 0;
  std::vector<ShardEntry> shards;
  std::vector<LayerEntry> layers;
};

/// Names of a build's files, relative to its folder.
inline constexpr const char* kBuildName = "build.xml";
inline constexpr const char* kUnfinishedName = "unfinished.xml";  ///< stands in for build.xml while layers are written
inline constexpr const char* kMasterName = "layers.h5";
inline constexpr const char* kShardFolder = "layers";
inline constexpr std::string_view kBuildNamespace = "urn:lamella:build:1";

/// More layers than this would make build.xml larger than core/xml.h reads.
inline constexpr std::size_t kMaxStoredLayers = 200'000;

/// "layers/000003.h5"
[[nodiscard]] std::string shard_name(std::size_t shard);
/// "layer_000012", the group of a layer in its shard and in layers.h5.
[[nodiscard]] std::string layer_group_name(std::size_t layer);

/// The text of build.xml, or of unfinished.xml when there is no `report` and index yet.
[[nodiscard]] std::string write_build_xml(const BuildFile& build, bool is_complete);

/// Reads a complete build.xml. Throws InputError with file, line and hint when it is unfinished, malformed or
/// contradicts itself.
[[nodiscard]] BuildFile read_build_xml(const std::filesystem::path& path);

}  // namespace lamella
