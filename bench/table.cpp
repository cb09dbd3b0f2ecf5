#include "bench/table.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace lamella::bench {
namespace {

using Json = nlohmann::json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string number(double value, const char* format) {
  if (!std::isfinite(value)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Three digits, whatever the size.
std::string ratio(double value) { return number(value, value < 9.95 ? "%.2f" : value < 99.5 ? "%.1f" : "%.0f"); }

double whole_rate(const Json& model, const Json& peer, bool with_tessellation) {
  if (peer.contains("failed")) return kNone;
  return peer["hits"].get<double>() / peer["share"].get<double>() / whole_seconds(model, peer, with_tessellation);
}

/// The best rate of some peers on one tessellation ("" for none); NaN when none of them ran.
double best_rate(const Json& model, std::initializer_list<const char*> names, const std::string& mesh,
                 bool with_tessellation = false) {
  double best = kNone;
  for (const Json& peer : model["peers"]) {
    for (const char* name : names) {
      if (peer["peer"] == name && peer["mesh"] == mesh)
        best = std::fmax(best, whole_rate(model, peer, with_tessellation));
    }
  }
  return best;
}

double cast_rate(const Json& model, const char* name, const std::string& mesh) {
  for (const Json& peer : model["peers"]) {
    if (peer["peer"] == name && peer["mesh"] == mesh && !peer.contains("failed")) return peer["hits_per_s"];
  }
  return kNone;
}

double best_cast_rate(const Json& model, const std::string& mesh) {
  return std::fmax(cast_rate(model, "contour", mesh), cast_rate(model, "dexel", mesh));
}

std::string ratio_row(const Json& model) {
  const double span = best_rate(model, {"span"}, "");
  const double span_cast = cast_rate(model, "span", "");
  const auto over_mesh = [&](const char* mesh, bool with_tessellation) {
    return ratio(span / best_rate(model, {"contour", "dexel"}, mesh, with_tessellation));
  };
  std::string row = "| " + model["file"].get<std::string>() + " | " + number(span * 1e-6, "%.3g") + " | " +
                    number(best_rate(model, {"span+combine"}, "") * 1e-6, "%.3g") + " | ";
  row += over_mesh("0.001", false) + " | " + over_mesh("0.001", true) + " | " + over_mesh("0.01", false) + " | " +
         over_mesh("0.01", true) + " | ";
  row += ratio(span_cast / best_cast_rate(model, "0.001")) + " | " + ratio(span_cast / best_cast_rate(model, "0.01")) +
         " | ";
  row += ratio(span / best_rate(model, {"embree"}, "0.001")) + " | ";
  row += ratio(span_cast / cast_rate(model, "occt", "")) + " |\n";
  return row;
}

std::string peer_row(const Json& model, const Json& peer) {
  std::string row = "| " + model["file"].get<std::string>() + " | " + peer["peer"].get<std::string>() + " | " +
                    peer["mesh"].get<std::string>() + " | ";
  if (peer.contains("failed")) return row + "failed in " + peer["failed"].get<std::string>() + " | | | | | | | | | |\n";
  const Json& error = peer["error"];
  const bool has_mesh = peer["mesh"] != "";
  const double tessellation =
      has_mesh ? model["tessellations"][peer["mesh"].get<std::string>()]["seconds"].get<double>() : kNone;
  row += number(peer["hits_per_s"].get<double>() * 1e-6, "%.4g") + " | " + number(peer["prepare_s"], "%.3g") + " | " +
         number(tessellation, "%.3g") + " | " + number(peer["hits"], "%.0f") + " | ";
  row += number(peer["odd_rows"], "%.0f") + " of " + number(peer["solid_rows"], "%.0f") + " | " +
         number(error["count_mismatches"], "%.0f") + " of " + number(error["rows"], "%.0f") + " | ";
  row += number(error["mean"], "%.2g") + " | " + number(error["max"], "%.2g") + " | " +
         number(peer["peak_mib"], "%.0f") + " |\n";
  return row;
}

constexpr const char* kRatioHead =
    "| model | span engine, million hits/s | with segments | / mesh 0.001 | with tessellation | / mesh 0.01 | with "
    "tessellation | cast alone / mesh 0.001 | / mesh 0.01 | / Embree 0.001 | / OpenCASCADE, cast alone |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|\n";

constexpr const char* kPeerHead =
    "| model | peer | mesh, mm | million hits/s, cast alone | prepare, s | tessellation, s | hits | odd rows | wrong "
    "number of hits | error of x, mean, mm | largest | memory, MiB |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|---|\n";

}  // namespace

double whole_seconds(const Json& model, const Json& peer, bool with_tessellation) {
  double seconds = peer["prepare_s"].get<double>() + peer["cast_s"].get<double>() / peer["share"].get<double>();
  const std::string mesh = peer["mesh"];
  if (with_tessellation && !mesh.empty()) seconds += model["tessellations"][mesh]["seconds"].get<double>();
  return seconds;
}

std::string markdown_tables(const Json& results) {
  std::string text =
      "Hits per CPU second of one thread, preparing included unless it says cast alone; the same rows "
      "for all. A mesh is the faster of contour slicer and dexel rasteriser.\n\n";
  text += kRatioHead;
  for (const Json& model : results["models"]) text += ratio_row(model);
  text += std::string("\n") + kPeerHead;
  for (const Json& model : results["models"]) {
    for (const Json& peer : model["peers"]) text += peer_row(model, peer);
  }
  return text;
}

}  // namespace lamella::bench
