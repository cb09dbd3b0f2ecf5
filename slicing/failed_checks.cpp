#include "slicing/failed_checks.h"

#include <algorithm>
#include <string>

#include "core/xml.h"

namespace lamella {

namespace {

/// More are counted, not named.
constexpr std::size_t kMostNamed = 20;

const char* text_of(Check check) {
  switch (check) {
    case Check::closure:
      return "rows enter the solid and don't leave it";
    case Check::winding:
      return "rows enter the solid twice or leave it before they entered";
    case Check::balance:
      return "fronts and backs of the section don't balance";
    case Check::loops:
      return "a loop of the section could not be followed and is missing";
    case Check::arcs:
      return "an arc of the section could not be followed; a straight line stands in for it";
    case Check::depth:
      return "rows don't meet the arc that they cross";
  }
  return "";
}

}  // namespace

void FailedChecks::add(const FailedCheck& failed, std::size_t layer, double z) {
  Sum& sum = sums_[{failed.solid, failed.face, failed.check}];
  if (sum.layers == 0) {
    sum.first_layer = layer;
    sum.first_z = z;
  }
  if (sum.layers == 0 || sum.last_layer != layer) ++sum.layers;
  sum.last_layer = layer;
  sum.count += failed.count;
  sum.longest = std::max(sum.longest, failed.longest);
}

void FailedChecks::report(const Scene& scene, std::vector<Finding>& findings) const {
  std::size_t named = 0;
  for (const auto& [place, sum] : sums_) {
    if (named++ == kMostNamed) break;
    const auto& [solid, face, check] = place;
    Finding finding;
    finding.solid = scene.solids[solid].info.path;
    if (face.valid()) {
      finding.face = scene.faces[face].name;
      if (scene.faces[face].step_entity > 0) finding.entity = "#" + std::to_string(scene.faces[face].step_entity);
    }
    finding.what = std::string(text_of(check)) + ": layer " + std::to_string(sum.first_layer) +
                   " (z = " + format_double(sum.first_z) + " mm)";
    if (sum.layers > 1) finding.what += " and " + std::to_string(sum.layers - 1) + " more";
    finding.what += check == Check::loops ? ", loops: " : ", rows: ";
    finding.what += std::to_string(sum.count);
    if (sum.longest > 0.0) finding.what += ", over " + format_double(sum.longest) + " mm at most";
    finding.hint = "compare these layers with --engine reference";
    findings.push_back(std::move(finding));
  }
  if (sums_.size() <= kMostNamed) return;
  Finding rest;
  rest.what = "checks failed in " + std::to_string(sums_.size() - kMostNamed) + " more places";
  findings.push_back(std::move(rest));
}

}  // namespace lamella
