#include "export/accuracy_page.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>

#include "core/xml.h"
#include "export/log_chart.h"
#include "export/page_style.h"

namespace lamella {

namespace {

using accuracy::LatticeResult;
using accuracy::StlResult;
using accuracy::StudyResult;

std::string number(double value) { return fmt::format("{:.3g}", value); }

std::string megabytes(double bytes) {
  return bytes < 1e6 ? fmt::format("{:.3g} kB", bytes / 1e3) : fmt::format("{:.3g} MB", bytes / 1e6);
}

/// A series over the deflections that were measured, from fine to coarse.
LogSeries over_deflection(const StudyResult& result, const std::string& name,
                          const std::function<double(const StlResult&)>& value) {
  LogSeries series{name, {}, false};
  for (const StlResult& stl : result.stl) {
    if (stl.skipped.empty()) series.points.emplace_back(stl.deflection, value(stl));
  }
  std::reverse(series.points.begin(), series.points.end());
  return series;
}

LogSeries level(const std::string& name, double value) { return {name, {Vec2(0.0, value)}, false}; }

constexpr const char* kDeflection = "deflection in mm";

LogChart crossing_chart(const StudyResult& result) {
  LogChart chart{"Error of crossings along the rays", kDeflection, "error in mm", {}};
  chart.series.push_back(over_deflection(result, "STL, largest", [](const auto& s) { return s.errors.largest; }));
  chart.series.push_back(over_deflection(result, "STL, RMS", [](const auto& s) { return s.errors.rms(); }));
  chart.series.push_back(over_deflection(result, "STL, mean", [](const auto& s) { return s.errors.mean(); }));
  chart.series.push_back(level("direct, largest", result.direct.errors.largest));
  chart.series.push_back(level("direct, RMS", result.direct.errors.rms()));
  return chart;
}

LogChart distance_chart(const StudyResult& result) {
  LogChart chart{"Distance of the STL's crossings from the exact surface", kDeflection, "distance in mm", {}};
  chart.series.push_back(over_deflection(result, "largest", [](const auto& s) { return s.distance.largest; }));
  chart.series.push_back(over_deflection(result, "RMS", [](const auto& s) { return s.distance.rms; }));
  LogSeries asked = over_deflection(result, "the deflection asked for", [](const auto& s) { return s.deflection; });
  asked.is_dashed = true;
  chart.series.push_back(asked);
  chart.series.push_back(level("tolerance that the STEP file states", result.file_tolerance));
  return chart;
}

LogChart lost_chart(const StudyResult& result) {
  const auto hits = static_cast<double>(std::max<std::uint64_t>(1, result.direct.hits));
  LogChart chart{"Crossings missed and false, of all", kDeflection, "part of the crossings", {}};
  chart.series.push_back(
      over_deflection(result, "missed", [hits](const auto& s) { return static_cast<double>(s.errors.missed) / hits; }));
  chart.series.push_back(
      over_deflection(result, "false", [hits](const auto& s) { return static_cast<double>(s.errors.false_) / hits; }));
  return chart;
}

LogChart measure_chart(const StudyResult& result) {
  LogChart chart{"Relative error of sections and volume", kDeflection, "relative error", {}};
  chart.series.push_back(
      over_deflection(result, "areas of sections, RMS", [](const auto& s) { return s.area.rms / s.section_area; }));
  chart.series.push_back(
      over_deflection(result, "volume", [&result](const auto& s) { return s.volume_error / result.volume; }));
  return chart;
}

LogChart size_chart(const StudyResult& result) {
  LogChart chart{"Size of the files", kDeflection, "bytes", {}};
  chart.series.push_back(
      over_deflection(result, "STL, binary", [](const auto& s) { return static_cast<double>(s.bytes); }));
  chart.series.push_back(level("STEP", static_cast<double>(result.step_bytes)));
  return chart;
}

LogChart time_chart(const StudyResult& result) {
  LogChart chart{"Time for all rays", kDeflection, "time in s", {}};
  chart.series.push_back(
      over_deflection(result, "STL, tessellating and files included", [](const auto& s) { return s.seconds(); }));
  chart.series.push_back(over_deflection(result, "STL, slicing alone", [](const auto& s) { return s.slice_seconds; }));
  chart.series.push_back(level("direct", result.direct.prepare_seconds + result.direct.slice_seconds));
  return chart;
}

LogChart lattice_chart(const StudyResult& result) {
  LogChart chart{"What the lattice costs: volume by rows", "pitch in mm, along y and z", "relative error", {}};
  LogSeries found{"direct slicing, observed", {}, false};
  LogSeries bound{"guaranteed bound", {}, true};
  for (auto it = result.lattices.rbegin(); it != result.lattices.rend(); ++it) {
    found.points.emplace_back(it->pitch, it->volume_error / result.volume);
    bound.points.emplace_back(it->pitch, it->volume_bound / result.volume);
  }
  chart.series = {found, bound};
  return chart;
}

void write_card(std::ostream& out, const std::string& value, const std::string& label) {
  out << "<div class=\"card\"><b>" << value << "</b><span>" << label << "</span></div>\n";
}

void write_cards(const StudyResult& result, std::ostream& out) {
  out << "<div class=\"cards\">\n";
  write_card(out, fmt::format("{}", result.solids.size()), "closed solids");
  write_card(out, number(result.volume) + " mm&sup3;", "exact volume");
  write_card(out, fmt::format("{}", result.direct.rays), "rays, every " + number(result.pitch) + " mm");
  write_card(out, fmt::format("{}", result.direct.hits), "exact crossings");
  if (result.direct.oracle_rays > 0) {
    write_card(out, number(result.direct.errors.largest) + " mm",
               fmt::format("direct slicing's own largest error, on {} rays", result.direct.oracle_rays));
  }
  write_card(out, number(result.direct.prepare_seconds + result.direct.slice_seconds) + " s", "direct slicing");
  write_card(out, number(result.file_tolerance) + " mm", "tolerance of edges, as the file states");
  out << "</div>\n";
}

void write_stl_table(const StudyResult& result, std::ostream& out) {
  out << "<h2>STL files</h2>\n<div class=\"scroll\"><table><tr><th>deflection mm</th><th>triangles</th><th>size</th>"
      << "<th>max mm</th><th>RMS mm</th><th>mean mm</th><th>missed</th><th>false</th><th>longest missed mm</th>"
      << "<th>distance mm</th><th>area</th><th>volume</th><th>tessellate s</th><th>file s</th><th>slice s</th>"
      << "<th>memory</th></tr>\n";
  for (const StlResult& s : result.stl) {
    out << "<tr><td>" << fmt::format("{}", s.deflection) << "</td>";
    if (!s.skipped.empty()) {
      out << "<td class=\"text warning\" colspan=\"15\">skipped: " << xml_escape(s.skipped) << "</td></tr>\n";
      continue;
    }
    const std::vector<std::string> cells = {fmt::format("{}", s.triangles),
                                            megabytes(static_cast<double>(s.bytes)),
                                            number(s.errors.largest),
                                            number(s.errors.rms()),
                                            number(s.errors.mean()),
                                            fmt::format("{}", s.errors.missed),
                                            fmt::format("{}", s.errors.false_),
                                            number(s.errors.longest_missed),
                                            number(s.distance.largest),
                                            number(100.0 * s.area.rms / s.section_area) + " %",
                                            number(100.0 * s.volume_error / result.volume) + " %",
                                            number(s.tessellate_seconds),
                                            number(s.file_seconds),
                                            number(s.slice_seconds),
                                            s.peak_bytes > 0.0 ? megabytes(s.peak_bytes) : "unknown"};
    for (const std::string& cell : cells) out << "<td>" << cell << "</td>";
    out << "</tr>\n";
  }
  out << "</table></div>\n";
}

void write_lattice_table(const StudyResult& result, std::ostream& out) {
  out << "<h2>Lattices</h2>\n<div class=\"scroll\"><table><tr><th>pitch mm</th><th>rays</th><th>volume error</th>"
      << "<th>its bound</th><th>voxels reach mm</th><th>slice s</th></tr>\n";
  for (const LatticeResult& l : result.lattices) {
    out << "<tr><td>" << number(l.pitch) << "</td><td>" << l.rays << "</td><td>"
        << number(100.0 * l.volume_error / result.volume) << " %</td><td>"
        << number(100.0 * l.volume_bound / result.volume) << " %</td><td>" << number(l.surface_bound) << "</td><td>"
        << number(l.seconds) << "</td></tr>\n";
  }
  out << "</table></div>\n";
}

constexpr const char* kMethod = R"html(<h2>How it was measured</h2>
<p>Both sides were cut by the same rays along +x. Direct slicing cuts the exact surfaces of the STEP file. For the other side
OpenCASCADE tessellated the same solids at each deflection, each became a binary STL file (coordinates in single precision),
and the files were read back and sliced in double precision. Crossings of a solid on a ray are matched in their order, so that
the total length is least; those that have no partner are missed (of the exact ones) or false (of the mesh). Direct slicing's
own error is that against the certified interval method on some of the rays. Errors along a ray grow where it grazes the
surface, so the distance from the surface is given too. Zeros have no place on logarithmic axes.</p>
)html";

}  // namespace

void write_accuracy_page(const StudyResult& result, const std::string& title, std::ostream& out) {
  out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      << "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Accuracy: " << xml_escape(title)
      << "</title><style>" << kPageStyle << kLogChartStyle
      << "</style></head><body>\n<h1>Accuracy: " << xml_escape(title)
      << "</h1>\n<p>Direct slicing of the exact surfaces against slicing STL files</p>\n";
  write_cards(result, out);
  out << "<h2>Charts</h2>\n<div class=\"charts\">\n";
  for (const LogChart& chart : {crossing_chart(result), distance_chart(result), lost_chart(result),
                                measure_chart(result), size_chart(result), time_chart(result), lattice_chart(result)}) {
    out << log_chart(chart);
  }
  out << "</div>\n";
  write_stl_table(result, out);
  write_lattice_table(result, out);
  out << kMethod << "</body></html>\n";
}

}  // namespace lamella
