#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slicing/layer_sink.h"

namespace lamella::apps {

/// How a format is written, where it has a choice.
struct FormatOptions {
  bool xml_text = false;               ///< numbers of the XML slices as text
  bool vdb_ids = false;                ///< an Int32 grid of material ids in the VDB
  std::optional<std::string> plan;     ///< plan.xml, for G-code
  std::optional<std::string> machine;  ///< machine.xml, for G-code
  bool dither = false;                 ///< graded materials dithered in png, png-indexed and vdb
  int grey_bits = 8;                   ///< of png-grey
};

/// One output of a run.
struct Output {
  std::string format;  ///< "store", or a name that export --to takes
  std::filesystem::path path;
};

/// A file that a run has written.
struct WrittenFile {
  std::filesystem::path path;
  std::uintmax_t bytes = 0;
};

/// The formats that can be written now, in the order of docs/command.md.
[[nodiscard]] const std::vector<std::string>& available_formats();

/// Throws UsageError that lists the available formats unless `format` is one of them.
void check_format(const std::string& format);

/// Adds --xml-payload, --vdb-ids and --plan; read_format_options() reads them and --machine after the parse.
void add_format_options(CLI::App& verb);
[[nodiscard]] FormatOptions read_format_options(const CLI::App& verb);
/// Throws UsageError when an output lacks an option that it needs, or --plan is given without G-code.
void check_format_options(const FormatOptions& options, const std::vector<Output>& outputs);

/// A sink for "store" or any available format. Throws UsageError on others.
[[nodiscard]] std::unique_ptr<LayerSink> make_sink(const Output& output, const FormatOptions& options);

/// Throws UsageError when an output is one of the inputs, or lies where another output lies.
void refuse_inputs_as_outputs(const std::vector<std::filesystem::path>& outputs,
                              const std::vector<std::string>& inputs);

/// Throws ExportError when an output certainly can't be written: a file where a folder is needed, a folder where a file
/// is needed, or a place where nothing may be created. Creates nothing.
void check_writable(const Output& output);

/// The files of an output, by name; none when it doesn't exist.
[[nodiscard]] std::vector<WrittenFile> list_files(const std::filesystem::path& path);

}  // namespace lamella::apps
