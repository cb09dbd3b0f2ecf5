#include "apps/outputs.h"

#include <algorithm>
#include <array>
#include <unistd.h>

#include "apps/options.h"
#include "core/error.h"
#include "export/dither_sink.h"
#include "export/gcode_sink.h"
#include "export/grey_png_stack.h"
#include "export/png_stack.h"
#include "export/vdb/vdb_sink.h"
#include "export/xml_slices.h"
#include "slicing/store/build_file.h"
#include "slicing/store/store.h"

namespace lamella::apps {

namespace fs = std::filesystem;

namespace {

/// Formats of docs/command.md whose exporters aren't there yet.
constexpr std::array kPlannedFormats{"polyjet", "tiff",       "sl1", "vti", "vtp", "nrrd", "mhd",
                                     "cli",     "cli-binary", "3mf", "svg", "slc", "step"};

/// Where the path leads when links and dots are followed as far as it exists.
fs::path resolved(const fs::path& path) {
  std::error_code failure;
  const fs::path full = fs::absolute(path, failure);
  fs::path real = fs::weakly_canonical(full, failure);
  if (failure) return full.lexically_normal();
  return real.has_filename() ? real : real.parent_path();
}

bool is_folder_format(const std::string& format) { return format != "xml" && format != "vdb" && format != "gcode"; }

/// The nearest part of the path that exists.
fs::path existing_part(fs::path path) {
  path = fs::absolute(path);
  std::error_code failure;
  while (!fs::exists(path, failure) && path.has_relative_path()) path = path.parent_path();
  return path;
}

void check_build_folder(const fs::path& folder) {
  std::error_code failure;
  if (fs::is_empty(folder, failure) || failure) return;
  for (const char* name : {kBuildName, kUnfinishedName}) {
    if (fs::exists(folder / name, failure)) return;
  }
  throw UsageError("the folder holds files but no build", folder.string(), "choose an empty or a new folder");
}

}  // namespace

const std::vector<std::string>& available_formats() {
  static const std::vector<std::string> formats{"png", "png-indexed", "png-grey", "vdb", "xml", "gcode"};
  return formats;
}

void check_format(const std::string& format) {
  const auto& known = available_formats();
  if (std::find(known.begin(), known.end(), format) != known.end()) return;
  const bool planned = std::find(kPlannedFormats.begin(), kPlannedFormats.end(), format) != kPlannedFormats.end();
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  throw UsageError("format '" + format + (planned ? "' isn't there yet" : "' isn't known"), "--to",
                   "available: " + list);
}

void add_format_options(CLI::App& verb) {
  add_value(verb, "--xml-payload", "numbers in the XML: binary (zlib + base64, the default) or text", "KIND");
  add_switch(verb, "--vdb-ids", "also an Int32 grid of material ids in the VDB");
  add_value(verb, "--plan", "the build's plan, for G-code", "plan.xml");
  add_switch(verb, "--dither", "graded materials in png, png-indexed and vdb as voxels of what they are mixed of");
  add_value(verb, "--grey-bits", "bits a pixel of png-grey: 8 (the default) or 16", "N");
}

FormatOptions read_format_options(const CLI::App& verb) {
  FormatOptions options;
  if (const auto payload = given(verb, "--xml-payload")) {
    if (*payload != "text" && *payload != "binary") {
      throw UsageError("'" + *payload + "' is no payload", "--xml-payload", "give text or binary");
    }
    options.xml_text = *payload == "text";
  }
  options.vdb_ids = verb.count("--vdb-ids") > 0;
  options.dither = verb.count("--dither") > 0;
  if (const auto bits = given(verb, "--grey-bits")) {
    if (*bits != "8" && *bits != "16") throw UsageError("'" + *bits + "' bits", "--grey-bits", "give 8 or 16");
    options.grey_bits = *bits == "16" ? 16 : 8;
  }
  options.plan = given(verb, "--plan");
  options.machine = given(verb, "--machine");
  return options;
}

void check_format_options(const FormatOptions& options, const std::vector<Output>& outputs) {
  const bool has_gcode =
      std::any_of(outputs.begin(), outputs.end(), [](const Output& output) { return output.format == "gcode"; });
  if (!has_gcode) {
    if (options.plan) throw UsageError("only gcode takes a plan", "--plan", "leave it out");
    return;
  }
  if (!options.plan) throw UsageError("gcode needs --plan", {}, "make one with lamella plan");
  if (!options.machine) throw UsageError("gcode needs --machine", {}, "name the machine that the plan is for");
}

namespace {

std::unique_ptr<LayerSink> make_plain_sink(const Output& output, const FormatOptions& options) {
  if (output.format == "store") return make_store_sink(output.path);
  check_format(output.format);
  if (output.format == "png") return make_png_sink(output.path);
  if (output.format == "png-grey") return make_grey_png_sink(output.path, options.grey_bits);
  if (output.format == "png-indexed") return make_indexed_png_sink(output.path);
  if (output.format == "vdb") return make_vdb_sink(output.path, {.integer_ids = options.vdb_ids});
  if (output.format == "gcode") {
    return make_gcode_sink(output.path, {read_plan_xml(*options.plan), read_machine(*options.machine)});
  }
  return make_xml_sink(output.path, options.xml_text ? XmlPayload::text : XmlPayload::binary);
}

/// The formats whose voxels have one material each.
bool can_dither(const std::string& format) { return format == "png" || format == "png-indexed" || format == "vdb"; }

}  // namespace

std::unique_ptr<LayerSink> make_sink(const Output& output, const FormatOptions& options) {
  auto sink = make_plain_sink(output, options);
  return options.dither && can_dither(output.format) ? make_dither_sink(std::move(sink)) : std::move(sink);
}

namespace {

/// Whether `inner` is `outer` or lies below it.
bool is_within(const fs::path& inner, const fs::path& outer) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

}  // namespace

void refuse_inputs_as_outputs(const std::vector<fs::path>& outputs, const std::vector<std::string>& inputs) {
  std::vector<fs::path> taken;
  for (const std::string& input : inputs) taken.push_back(resolved(input));
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const fs::path place = resolved(outputs[i]);
    for (std::size_t j = 0; j < taken.size(); ++j) {
      const bool is_input = j < inputs.size();
      if (is_input && place == taken[j]) {
        throw UsageError("an output would overwrite an input", outputs[i].string(), "choose another name");
      }
      if (!is_input && (is_within(place, taken[j]) || is_within(taken[j], place))) {
        throw UsageError(place == taken[j] ? "two outputs have the same place" : "an output lies inside another",
                         outputs[i].string(), "choose a place of its own");
      }
    }
    taken.push_back(place);
  }
}

void check_writable(const Output& output) {
  if (output.path.empty()) throw UsageError("an empty path", output.format, "name a place for the output");
  std::error_code failure;
  const bool exists = fs::exists(output.path, failure);
  const bool is_folder = fs::is_directory(output.path, failure);
  if (exists && is_folder != is_folder_format(output.format)) {
    throw ExportError(
        is_folder ? "a folder stands where a file is to be written" : "a file stands where a folder is needed",
        output.path.string(), "choose another name or remove it");
  }
  const fs::path above = existing_part(output.path);
  if (::access(above.c_str(), W_OK) != 0) {
    throw ExportError("can't write there", above.string(), "check the permissions");
  }
  if (is_folder && output.format == "store") check_build_folder(output.path);
}

std::vector<WrittenFile> list_files(const fs::path& path) {
  std::vector<WrittenFile> files;
  std::error_code failure;
  if (fs::is_regular_file(path, failure)) return {{path, fs::file_size(path, failure)}};
  for (fs::recursive_directory_iterator entry(path, failure), end; !failure && entry != end; entry.increment(failure)) {
    if (entry->is_regular_file(failure)) files.push_back({entry->path(), entry->file_size(failure)});
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return files;
}

}  // namespace lamella::apps
