#include "apps/accuracy_report.h"

#include <cmath>
#include <fmt/format.h>

#include "apps/table.h"

namespace lamella::apps {

namespace {

using accuracy::CrossingErrors;
using accuracy::DirectResult;
using accuracy::LatticeResult;
using accuracy::StlResult;
using accuracy::StudyResult;

/// The keys that errors of crossings have on both sides.
void add_errors(const CrossingErrors& errors, Json& object) {
  object["max_error"] = errors.largest;
  object["rms_error"] = errors.rms();
  object["mean_error"] = errors.mean();
  object["matched"] = errors.matched;
  object["missed"] = errors.missed;
  object["false"] = errors.false_;
  object["longest_missed"] = errors.longest_missed;
  object["longest_false"] = errors.longest_false;
}

/// How far direct slicing is from OpenCASCADE's intersections; null when it wasn't asked.
Json occt_json(const DirectResult& direct) {
  if (direct.occt_rays == 0) return nullptr;
  Json object{{"rays", direct.occt_rays}, {"odd_rays", direct.occt_odd_rays}, {"time", direct.occt_seconds}};
  add_errors(direct.occt_errors, object);
  return object;
}

Json direct_json(const StudyResult& result) {
  const DirectResult& direct = result.direct;
  Json object{{"bytes", result.step_bytes},
              {"rays", direct.rays},
              {"hits", direct.hits},
              {"unclosed_rays", direct.counters.unclosed_rays},
              {"repaired_rays", direct.counters.repaired_rays},
              {"uncertain_hits", direct.counters.uncertain_hits},
              {"time", direct.prepare_seconds + direct.slice_seconds},
              {"time_prepare", direct.prepare_seconds},
              {"time_slice", direct.slice_seconds},
              {"oracle_rays", direct.oracle_rays},
              {"oracle_unclosed_rays", direct.oracle_counters.unclosed_rays},
              {"oracle_repaired_rays", direct.oracle_counters.repaired_rays},
              {"oracle_time", direct.oracle_seconds},
              {"occt", occt_json(direct)}};
  add_errors(direct.errors, object);
  if (direct.oracle_rays == 0) {
    for (const char* key : {"max_error", "rms_error", "mean_error", "matched", "missed", "false", "longest_missed",
                            "longest_false", "oracle_unclosed_rays", "oracle_repaired_rays"}) {
      object[key] = nullptr;
    }
  }
  return object;
}

Json stl_json(const StudyResult& result, const StlResult& stl) {
  Json object{{"deflection", stl.deflection}, {"skipped", text_or_null(stl.skipped)}};
  if (!stl.skipped.empty()) {
    for (const char* key : {"triangles", "bytes", "max_error", "rms_error", "volume_error", "time"}) {
      object[key] = nullptr;
    }
    return object;
  }
  object["triangles"] = stl.triangles;
  object["bytes"] = stl.bytes;
  add_errors(stl.errors, object);
  object["max_distance"] = stl.distance.largest;
  object["rms_distance"] = stl.distance.rms;
  object["distance_samples"] = stl.distance_samples;
  object["max_area_error"] = stl.area.largest;
  object["rms_area_error"] = stl.area.rms;
  object["relative_area_error"] = stl.area.rms / stl.section_area;
  object["volume_error"] = stl.volume_error;
  object["relative_volume_error"] = stl.volume_error / result.volume;
  object["unclosed_rays"] = stl.unclosed_rays;
  object["untessellated_faces"] = stl.faces_without;
  object["time"] = stl.seconds();
  object["time_tessellate"] = stl.tessellate_seconds;
  object["time_file"] = stl.file_seconds;
  object["time_slice"] = stl.slice_seconds;
  object["peak_memory_bytes"] = stl.peak_bytes > 0.0 ? Json(std::llround(stl.peak_bytes)) : Json(nullptr);
  return object;
}

Json lattice_json(const StudyResult& result, const LatticeResult& lattice) {
  return {{"pitch", lattice.pitch},
          {"rays", lattice.rays},
          {"volume_error", lattice.volume_error},
          {"volume_bound", lattice.volume_bound},
          {"relative_volume_error", lattice.volume_error / result.volume},
          {"surface_bound", lattice.surface_bound},
          {"time", lattice.seconds}};
}

std::string short_seconds(double seconds) { return fmt::format("{:.3g}", seconds); }

std::string length(double value) { return fmt::format("{:.3g}", value); }

std::string direct_text(const StudyResult& result) {
  const DirectResult& direct = result.direct;
  std::string text =
      fmt::format("rays {} ({} rows, {} layers, every {} mm), hits {}; direct slicing {} s ({} s of them preparing)\n",
                  direct.rays, result.rows, result.layers, length(result.pitch), direct.hits,
                  short_seconds(direct.prepare_seconds + direct.slice_seconds), short_seconds(direct.prepare_seconds));
  if (direct.oracle_rays > 0) {
    text += fmt::format(
        "against the certified engine on {} of the rays: largest error {} mm, rms {} mm, missed {}, false {}\n",
        direct.oracle_rays, length(direct.errors.largest), length(direct.errors.rms()), direct.errors.missed,
        direct.errors.false_);
  }
  if (direct.occt_rays > 0) {
    text += fmt::format(
        "against OpenCASCADE on {} rays of a solid, {} of them odd: largest difference {} mm, rms {} mm, only there "
        "{}, "
        "only here {}\n",
        direct.occt_rays, direct.occt_odd_rays, length(direct.occt_errors.largest), length(direct.occt_errors.rms()),
        direct.occt_errors.missed, direct.occt_errors.false_);
  }
  text += fmt::format("the STEP file states its edges to {} mm, and has {}\n", length(result.file_tolerance),
                      short_bytes(static_cast<double>(result.step_bytes)));
  return text;
}

std::string stl_text(const StudyResult& result) {
  TextTable table({{"deflection mm", true},
                   {"triangles", true},
                   {"STL", true},
                   {"max mm", true},
                   {"rms mm", true},
                   {"mean mm", true},
                   {"missed", true},
                   {"false", true},
                   {"distance mm", true},
                   {"area %", true},
                   {"volume %", true},
                   {"tessellate s", true},
                   {"file s", true},
                   {"slice s", true}});
  std::string skipped;
  for (const StlResult& stl : result.stl) {
    if (!stl.skipped.empty()) {
      skipped += fmt::format("{} mm skipped: {}\n", stl.deflection, stl.skipped);
      continue;
    }
    table.add({fmt::format("{}", stl.deflection), std::to_string(stl.triangles),
               short_bytes(static_cast<double>(stl.bytes)), length(stl.errors.largest), length(stl.errors.rms()),
               length(stl.errors.mean()), std::to_string(stl.errors.missed), std::to_string(stl.errors.false_),
               length(stl.distance.largest), length(100.0 * stl.area.rms / stl.section_area),
               length(100.0 * stl.volume_error / result.volume), short_seconds(stl.tessellate_seconds),
               short_seconds(stl.file_seconds), short_seconds(stl.slice_seconds)});
  }
  return table.text() + skipped;
}

std::string lattice_text(const StudyResult& result) {
  TextTable table({{"pitch mm", true},
                   {"rays", true},
                   {"volume error %", true},
                   {"its bound %", true},
                   {"voxels reach mm", true},
                   {"slice s", true}});
  for (const LatticeResult& lattice : result.lattices) {
    table.add({fmt::format("{:.3g}", lattice.pitch), std::to_string(lattice.rays),
               length(100.0 * lattice.volume_error / result.volume),
               length(100.0 * lattice.volume_bound / result.volume), length(lattice.surface_bound),
               short_seconds(lattice.seconds)});
  }
  return table.text();
}

/// Cells of a line of the CSV, by the names of the columns.
constexpr const char* kColumns[] = {"kind",
                                    "deflection",
                                    "pitch",
                                    "skipped",
                                    "rays",
                                    "triangles",
                                    "bytes",
                                    "max_error",
                                    "rms_error",
                                    "mean_error",
                                    "matched",
                                    "missed",
                                    "false",
                                    "longest_missed",
                                    "longest_false",
                                    "max_distance",
                                    "rms_distance",
                                    "max_area_error",
                                    "rms_area_error",
                                    "volume_error",
                                    "volume_bound",
                                    "surface_bound",
                                    "unclosed_rays",
                                    "time",
                                    "time_tessellate",
                                    "time_file",
                                    "time_slice",
                                    "peak_memory_bytes"};

void write_line(const char* kind, const Json& values, std::ostream& stream) {
  stream << kind;
  for (const char* column : std::span(kColumns).subspan(1)) {
    stream << ',';
    if (!values.contains(column) || values[column].is_null()) continue;
    // A reason is the only text; it holds no quotation marks.
    stream << values[column].dump();
  }
  stream << '\n';
}

}  // namespace

Json accuracy_json(const StudyResult& result) {
  Json stl = Json::array();
  for (const StlResult& one : result.stl) stl.push_back(stl_json(result, one));
  Json lattices = Json::array();
  for (const LatticeResult& one : result.lattices) lattices.push_back(lattice_json(result, one));
  Json solids = Json::array();
  for (const SolidId solid : result.solids) solids.push_back(solid.value());
  return {{"solids", solids},
          {"volume", result.volume},
          {"area", result.area},
          {"size", json_of(result.size)},
          {"file_tolerance", result.file_tolerance},
          {"rows", result.rows},
          {"layers", result.layers},
          {"pitch", result.pitch},
          {"direct", direct_json(result)},
          {"stl", stl},
          {"lattices", lattices}};
}

std::string accuracy_text(const StudyResult& result) {
  return direct_text(result) + "\nSTL files\n" + stl_text(result) + "\nlattices, directly sliced\n" +
         lattice_text(result);
}

void write_accuracy_csv(const StudyResult& result, std::ostream& stream) {
  for (const char* column : kColumns) stream << (column == kColumns[0] ? "" : ",") << column;
  stream << '\n';
  write_line("direct", direct_json(result), stream);
  for (const StlResult& one : result.stl) write_line("stl", stl_json(result, one), stream);
  for (const LatticeResult& one : result.lattices) write_line("lattice", lattice_json(result, one), stream);
}

}  // namespace lamella::apps
