#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "slicing/compensated_sum.h"
#include "slicing/contact/contacts.h"
#include "slicing/contour_findings.h"
#include "slicing/failed_checks.h"
#include "slicing/layer_cutter.h"
#include "slicing/report.h"

namespace lamella {

/// Adds up what was measured layer by layer, in increasing z, into a SliceReport.
class Tally {
 public:
  /// `solids` are those that are cut; the others are reported as left out.
  Tally(const Scene& scene, const MaterialTable& table, const IdVector<SolidId, SolidMeasure>& measures,
        const LayerPlan& plan, const std::vector<SolidId>& solids, std::span<const Contact> contacts);

  /// Adds the next layer. Throws InputError on an overlap under policy `error`.
  void add(const CutLayer& cut);

  /// Judges the volumes and writes the findings.
  [[nodiscard]] SliceReport finish();

 private:
  struct Pair {
    CompensatedSum volume;
    std::uint64_t layers = 0;
    double largest_depth = 0.0;
  };
  using Pairs = std::map<std::pair<SolidId, SolidId>, Pair>;

  void refuse_overlaps(const CutLayer& cut) const;
  void judge_solid(SolidId solid);
  void report_overlaps();
  void report_contacts();
  void report_casts();
  void report_mixing();
  void warn(SolidId solid, std::string what, std::string hint);
  [[nodiscard]] bool is_ambiguous(SolidId a, SolidId b) const;

  const Scene& scene_;
  const MaterialTable& table_;
  const IdVector<SolidId, SolidMeasure>& measures_;
  const LayerPlan& plan_;
  std::span<const Contact> contacts_;
  double thickest_ = 0.0;
  SliceReport report_;
  std::vector<CompensatedSum> solid_volume_;
  std::vector<CompensatedSum> material_volume_;
  Pairs overlaps_;
  Pairs gaps_;
  FailedChecks failed_;
  ContourFindings contour_findings_;
  MixFaults mixing_;
};

}  // namespace lamella
