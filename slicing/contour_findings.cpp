#include "slicing/contour_findings.h"

#include <utility>

namespace lamella {

namespace {

/// More are counted, not named.
constexpr std::size_t kMostNamed = 20;

}  // namespace

void ContourFindings::add(const Finding& finding) {
  const auto [group, is_new] = groups_.try_emplace({finding.solid, finding.entity, finding.severity});
  if (is_new) {
    group->second.first = finding;
  } else {
    ++group->second.more;
  }
}

void ContourFindings::report(std::vector<Finding>& findings) const {
  std::size_t named = 0;
  for (const auto& [key, group] : groups_) {
    if (named++ == kMostNamed) break;
    Finding finding = group.first;
    if (group.more > 0) finding.what += "; and " + std::to_string(group.more) + " more like it";
    findings.push_back(std::move(finding));
  }
  if (groups_.size() <= kMostNamed) return;
  Finding rest;
  rest.what = "contours of " + std::to_string(groups_.size() - kMostNamed) + " more faces have faults";
  findings.push_back(std::move(rest));
}

}  // namespace lamella
