#include "apps/formats.h"

#include <algorithm>
#include <array>

#include "apps/options.h"
#include "core/error.h"
#include "export/cli_sink.h"
#include "export/dither_sink.h"
#include "export/gcode_sink.h"
#include "export/grey_png_stack.h"
#include "export/mhd_file.h"
#include "export/nrrd_file.h"
#include "export/png_stack.h"
#include "export/polyjet_stack.h"
#include "export/slc_sink.h"
#include "export/step_sink.h"
#include "export/svg_sink.h"
#include "export/threemf_sink.h"
#include "export/tiff_file.h"
#include "export/vdb/vdb_sink.h"
#include "export/vti_file.h"
#include "export/vtp_sink.h"
#include "export/xml_slices.h"
#include "slicing/store/store.h"

namespace lamella::apps {

namespace {

using Path = std::filesystem::path;

VolumeOptions volume_options(const FormatOptions& options) {
  return {.z_pitch = options.z_pitch, .is_raw = options.raw};
}

constexpr std::array kFormats{
    Format{"png", "one stack of 1-bit images per material", true, true,
           [](const Path& path, const FormatOptions&) { return make_png_sink(path); }},
    Format{"png-indexed", "one stack of palette images of all materials", true, true,
           [](const Path& path, const FormatOptions&) { return make_indexed_png_sink(path); }},
    Format{"png-grey", "one stack of grey images of volume fractions per material", true, false,
           [](const Path& path, const FormatOptions& options) { return make_grey_png_sink(path, options.grey_bits); }},
    Format{
        "png-coverage", "one stack of grey images of covered pixel parts per material", true, false,
        [](const Path& path, const FormatOptions& options) { return make_coverage_png_sink(path, options.grey_bits); }},
    Format{"polyjet", "opaque RGBA images, one colour per material, as PolyJet machines take them", true, true,
           [](const Path& path, const FormatOptions& options) {
             return make_polyjet_sink(path, {.z_pitch = options.z_pitch, .fewest_slices = options.is_sample ? 1 : 30});
           }},
    Format{"tiff", "a TIFF of labels, a page per slice", false, true,
           [](const Path& path, const FormatOptions& options) {
             return make_tiff_sink(path, {.volume = volume_options(options)});
           }},
    Format{"sl1", "one archive of masks per material, for SLA printers", true, true,
           [](const Path& path, const FormatOptions& options) {
             return make_sl1_sink(path, {.z_pitch = options.z_pitch, .display = options.sl1_display});
           }},
    Format{"vdb", "OpenVDB grids", false, true,
           [](const Path& path, const FormatOptions& options) {
             VdbOptions grids = options.vdb;
             grids.z_pitch = options.z_pitch;
             return make_vdb_sink(path, grids);
           }},
    Format{"vti", "VTK image data of labels", false, true,
           [](const Path& path, const FormatOptions& options) { return make_vti_sink(path, volume_options(options)); }},
    Format{
        "nrrd", "an NRRD of labels, a segmentation for 3D Slicer", false, true,
        [](const Path& path, const FormatOptions& options) { return make_nrrd_sink(path, volume_options(options)); }},
    Format{"mhd", "a MetaImage of labels, its data beside it", false, true,
           [](const Path& path, const FormatOptions& options) { return make_mhd_sink(path, volume_options(options)); }},
    Format{"xml", "XML slices", false, false,
           [](const Path& path, const FormatOptions& options) {
             return make_xml_sink(path, options.xml_text ? XmlPayload::text : XmlPayload::binary);
           }},
    Format{"svg", "contours, one picture per layer", true, false,
           [](const Path& path, const FormatOptions&) { return make_svg_sink(path); }, Contours::needed},
    Format{"cli", "CLI 2.0 layers: hatches and contours", false, false,
           [](const Path& path, const FormatOptions&) { return make_cli_sink(path); }, Contours::used},
    Format{"cli-binary", "the same in the binary form", false, false,
           [](const Path& path, const FormatOptions&) { return make_binary_cli_sink(path); }, Contours::used},
    Format{"slc", "SLC 2.0 contours, one file per material", true, false,
           [](const Path& path, const FormatOptions&) { return make_slc_sink(path); }, Contours::needed},
    Format{"3mf", "3MF with slices, one object per material", false, false,
           [](const Path& path, const FormatOptions&) { return make_3mf_sink(path); }, Contours::needed},
    Format{"vtp", "VTK lines of segments and contours, one file per layer", true, false,
           [](const Path& path, const FormatOptions&) { return make_vtp_sink(path); }, Contours::used},
    Format{"step", "STEP wireframe of contours by layer and material", false, false,
           [](const Path& path, const FormatOptions& options) {
             return make_step_sink(path, {.hatches = options.step_hatches});
           },
           Contours::needed},
    Format{"gcode", "multi-tool raster G-code", false, false,
           [](const Path& path, const FormatOptions& options) {
             return make_gcode_sink(path, {read_plan_xml(*options.plan), read_machine(*options.machine)});
           }},
};

}  // namespace

std::span<const Format> available_formats() { return kFormats; }

const Format* find_format(const std::string& name) {
  const auto* const found =
      std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) { return format.name == name; });
  return found == kFormats.end() ? nullptr : found;
}

void check_format(const std::string& name) {
  if (find_format(name) != nullptr) return;
  std::string list;
  for (const Format& format : kFormats) list += (list.empty() ? "" : ", ") + std::string(format.name);
  throw UsageError("format '" + name + "' isn't known", "--to", "available: " + list);
}

void add_format_options(CLI::App& verb) {
  add_value(verb, "--xml-payload", "numbers in the XML: binary (zlib + base64, the default) or text", "KIND");
  add_value(verb, "--vdb-grids", "the VDB's grids, of density, labels and fog (one a material); default: all", "LIST");
  add_switch(verb, "--vdb-ids", "also an Int32 grid of material ids in the VDB");
  add_switch(verb, "--vdb-sdf", "also a level set of each material in the VDB; voxels must be cubes");
  add_value(verb, "--plan", "the build's plan, for G-code", "plan.xml");
  add_switch(verb, "--dither", "graded materials as voxels of what they are mixed of, where voxels have one material");
  add_value(verb, "--grey-bits", "bits a pixel of png-grey and png-coverage: 8 (the default) or 16", "N");
  add_value(verb, "--coverage-rows", "lines across a row of pixels that png-coverage is the mean of (default: 4)", "N");
  add_value(verb, "--sl1-display", "of portrait, mirror-x and mirror-y what the printer's display needs", "LIST");
  add_switch(verb, "--step-hatches", "hatch rows in the STEP file too");
  add_value(verb, "--z-pitch", "thickness of slices where a format has but one: the nearest layer", "MM");
  add_switch(verb, "--raw", "tiff, vti, nrrd and mhd without compression");
}

namespace {

/// Names with commas between.
void choose_grids(const std::string& list, VdbOptions& vdb) {
  vdb.density = vdb.labels = vdb.fog = false;
  for (const std::string& name : CLI::detail::split(list, ',')) {
    bool* const grid = name == "density"  ? &vdb.density
                       : name == "labels" ? &vdb.labels
                       : name == "fog"    ? &vdb.fog
                                          : nullptr;
    if (grid == nullptr) {
      throw UsageError("'" + name + "' is no grid", "--vdb-grids", "give any of density,labels,fog");
    }
    *grid = true;
  }
}

/// Names with commas between.
Sl1Display read_display(const std::string& list) {
  Sl1Display display;
  for (const std::string& name : CLI::detail::split(list, ',')) {
    bool* const choice = name == "portrait"   ? &display.is_portrait
                         : name == "mirror-x" ? &display.mirror_x
                         : name == "mirror-y" ? &display.mirror_y
                                              : nullptr;
    if (choice == nullptr) {
      throw UsageError("'" + name + "' is no way to lay a picture", "--sl1-display",
                       "give any of portrait,mirror-x,mirror-y");
    }
    *choice = true;
  }
  return display;
}

}  // namespace

FormatOptions read_format_options(const CLI::App& verb) {
  FormatOptions options;
  if (const auto payload = given(verb, "--xml-payload")) {
    if (*payload != "text" && *payload != "binary") {
      throw UsageError("'" + *payload + "' is no payload", "--xml-payload", "give text or binary");
    }
    options.xml_text = *payload == "text";
  }
  if (const auto grids = given(verb, "--vdb-grids")) choose_grids(*grids, options.vdb);
  options.vdb.integer_ids = verb.count("--vdb-ids") > 0;
  options.vdb.signed_distance = verb.count("--vdb-sdf") > 0;
  options.dither = verb.count("--dither") > 0;
  if (const auto bits = given(verb, "--grey-bits")) {
    if (*bits != "8" && *bits != "16") throw UsageError("'" + *bits + "' bits", "--grey-bits", "give 8 or 16");
    options.grey_bits = *bits == "16" ? 16 : 8;
  }
  if (const auto rows = given(verb, "--coverage-rows")) {
    options.coverage_rows = static_cast<int>(parse_whole("--coverage-rows", *rows, 1, 64));
  }
  if (const auto display = given(verb, "--sl1-display")) options.sl1_display = read_display(*display);
  options.step_hatches = verb.count("--step-hatches") > 0;
  options.raw = verb.count("--raw") > 0;
  if (const auto pitch = given(verb, "--z-pitch")) options.z_pitch = parse_positive("--z-pitch", *pitch);
  options.plan = given(verb, "--plan");
  options.machine = given(verb, "--machine");
  return options;
}

namespace {

/// An option and the formats that it is for, with spaces around each.
struct FormatOption {
  const char* name;
  const char* formats;
};
constexpr std::array kOptionsOfFormats{
    FormatOption{"--xml-payload", " xml "},
    FormatOption{"--vdb-grids", " vdb "},
    FormatOption{"--vdb-ids", " vdb "},
    FormatOption{"--vdb-sdf", " vdb "},
    FormatOption{"--grey-bits", " png-grey png-coverage "},
    FormatOption{"--sl1-display", " sl1 "},
    FormatOption{"--step-hatches", " step "},
    FormatOption{"--z-pitch", " polyjet tiff sl1 vdb vti nrrd mhd "},
    FormatOption{"--raw", " tiff vti nrrd mhd "},
};

/// An option that changes nothing is a slip of its user.
void refuse_idle_options(const CLI::App& verb, const std::vector<Output>& outputs) {
  for (const FormatOption& option : kOptionsOfFormats) {
    const std::string_view formats = option.formats;
    const bool is_used = std::any_of(outputs.begin(), outputs.end(), [&](const Output& output) {
      return formats.find(" " + output.format + " ") != std::string_view::npos;
    });
    if (verb.count(option.name) > 0 && !is_used) {
      throw UsageError("no output is of a format that this is for", option.name,
                       "it is for" + std::string(formats.substr(0, formats.size() - 1)));
    }
  }
  const bool can_dither = std::any_of(outputs.begin(), outputs.end(), [](const Output& output) {
    const Format* format = find_format(output.format);
    return format != nullptr && format->has_single_materials;
  });
  if (verb.count("--dither") > 0 && !can_dither) {
    throw UsageError("no output has voxels of one material", "--dither", "it is for pictures and volumes of labels");
  }
}

}  // namespace

void check_format_options(const CLI::App& verb, const FormatOptions& options, const std::vector<Output>& outputs) {
  refuse_idle_options(verb, outputs);
  const bool has_gcode =
      std::any_of(outputs.begin(), outputs.end(), [](const Output& output) { return output.format == "gcode"; });
  if (!has_gcode) {
    if (options.plan) throw UsageError("only gcode takes a plan", "--plan", "leave it out");
    return;
  }
  if (!options.plan) throw UsageError("gcode needs --plan", {}, "make one with lamella plan");
  if (!options.machine) throw UsageError("gcode needs --machine", {}, "name the machine that the plan is for");
}

std::unique_ptr<LayerSink> make_sink(const Output& output, const FormatOptions& options) {
  if (output.format == "store") return make_store_sink(output.path);
  check_format(output.format);
  const Format& format = *find_format(output.format);
  auto sink = format.make(output.path, options);
  return options.dither && format.has_single_materials ? make_dither_sink(std::move(sink)) : std::move(sink);
}

}  // namespace lamella::apps
