#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "export/sl1_archives.h"
#include "export/vdb/vdb_sink.h"
#include "slicing/layer_sink.h"

namespace lamella::apps {

/// How a format is written, where it has a choice.
struct FormatOptions {
  bool xml_text = false;               ///< numbers of the XML slices as text
  VdbOptions vdb{};                    ///< the VDB's grids
  std::optional<std::string> plan;     ///< plan.xml, for G-code
  std::optional<std::string> machine;  ///< machine.xml, for G-code
  bool dither = false;                 ///< graded materials dithered where voxels have one material
  Sl1Display sl1_display{};            ///< how sl1's pictures lie
  std::optional<double> z_pitch;       ///< mm, slices of formats with one thickness
  bool is_sample = false;              ///< of a few layers, to estimate from
  bool raw = false;                    ///< volumes of labels not compressed
  int grey_bits = 8;                   ///< of png-grey and png-coverage
  int coverage_rows = 4;               ///< of png-coverage: lines across a row of pixels, when slicing
  bool step_hatches = false;           ///< hatch rows in the STEP file too
};

/// One output of a run.
struct Output {
  std::string format;  ///< "store", or a name that export --to takes
  std::filesystem::path path;
};

/// What a format makes of contours.
enum class Contours {
  none,
  used,   ///< when the build has them
  needed  ///< can't be written without
};

/// One format that can be written.
struct Format {
  const char* name;
  const char* summary;        ///< for --help
  bool is_folder;             ///< of several files, else one file
  bool has_single_materials;  ///< a voxel has one material, so that graded materials may be dithered
  std::unique_ptr<LayerSink> (*make)(const std::filesystem::path& path, const FormatOptions& options);
  Contours contours = Contours::none;  ///< made without being asked for when a run writes the format
};

/// The formats that can be written now, in the order of docs/command.md.
[[nodiscard]] std::span<const Format> available_formats();

/// The format of that name, or null.
[[nodiscard]] const Format* find_format(const std::string& name);

/// Throws UsageError that lists the available formats unless `name` is one of them.
void check_format(const std::string& name);

/// Adds the options of formats but --machine; read_format_options() reads all after the parse.
void add_format_options(CLI::App& verb);
[[nodiscard]] FormatOptions read_format_options(const CLI::App& verb);
/// Throws UsageError when an output lacks an option that it needs, or an option is given that is for none of them.
void check_format_options(const CLI::App& verb, const FormatOptions& options, const std::vector<Output>& outputs);

/// A sink for "store" or any available format. Throws UsageError on others.
[[nodiscard]] std::unique_ptr<LayerSink> make_sink(const Output& output, const FormatOptions& options);

}  // namespace lamella::apps
