#include "slicing/tally.h"

#include <algorithm>
#include <cmath>

#include "core/xml.h"
#include "model/solid_status.h"

namespace lamella {

namespace {

/// g/cm^3 times mm^3 in g.
constexpr double kGramsPerDensityVolume = 1e-3;

/// The integrals of |n_y| and |n_z| are known within 1 % (model/measure.h).
constexpr double kNormalAreaSlack = 1.01;

std::vector<PairReport> pair_reports(const auto& pairs) {
  std::vector<PairReport> out;
  for (const auto& [ids, pair] : pairs) {
    out.push_back({ids.first, ids.second, pair.volume.value(), pair.layers, pair.largest_depth});
  }
  return out;
}

void add_volumes(std::vector<CompensatedSum>& volumes, const std::vector<double>& lengths, double area) {
  for (std::size_t i = 0; i < volumes.size(); ++i) volumes[i].add(lengths[i] * area);
}

void add_pairs(auto& pairs, const std::vector<PairLength>& lengths, double area) {
  for (const PairLength& length : lengths) {
    auto& pair = pairs[{length.first, length.second}];
    pair.volume.add(length.length * area);
    ++pair.layers;
  }
}

}  // namespace

Tally::Tally(const Scene& scene, const MaterialTable& table, const IdVector<SolidId, SolidMeasure>& measures,
             const LayerPlan& plan, const std::vector<SolidId>& solids, std::span<const Contact> contacts)
    : scene_(scene),
      table_(table),
      measures_(measures),
      plan_(plan),
      contacts_(contacts),
      solid_volume_(scene.solids.size()),
      material_volume_(table.materials.size()) {
  for (const LayerSpan& layer : plan.layers) thickest_ = std::max(thickest_, layer.z_top - layer.z_bottom);
  report_.solids.resize(scene.solids.size());
  report_.materials.resize(table.materials.size());
  for (const SolidId solid : scene.solids.ids()) {
    report_.solids[solid].status = status_word(scene.solids[solid].info);
    report_.solids[solid].left_out = std::find(solids.begin(), solids.end(), solid) == solids.end();
  }
  report_.layers = plan.layers.size();
  report_.rows = report_.rays = plan.layers.size() * static_cast<std::uint64_t>(plan.grid.size[1]);
}

void Tally::add(const CutLayer& cut) {
  report_.cast += cut.cast;
  for (const FailedCheck& failed : cut.failed) failed_.add(failed, cut.layer.index, cut.layer.z_sample);
  mixing_ += cut.mixing;
  for (const Finding& finding : cut.contour_findings) contour_findings_.add(finding);
  if (table_.policy == OverlapPolicy::error) refuse_overlaps(cut);
  const double area = plan_.grid.pitch.y() * (cut.layer.z_top - cut.layer.z_bottom);
  report_.segments += cut.layer.raster.segments.size();
  add_volumes(solid_volume_, cut.lengths.solids, area);
  add_volumes(material_volume_, cut.lengths.materials, area);
  add_pairs(overlaps_, cut.lengths.overlaps, area);
  add_pairs(gaps_, cut.lengths.gaps, area);
  for (const PairLength& depth : cut.lengths.depths) {
    Pair& pair = overlaps_[{depth.first, depth.second}];
    pair.largest_depth = std::max(pair.largest_depth, depth.length);
  }
}

bool Tally::is_ambiguous(SolidId a, SolidId b) const {
  return table_.assignments[a].priority == table_.assignments[b].priority;
}

void Tally::refuse_overlaps(const CutLayer& cut) const {
  for (const PairLength& overlap : cut.lengths.overlaps) {
    if (!is_ambiguous(overlap.first, overlap.second)) continue;
    throw InputError("solids of equal priority and different material overlap",
                     "solids '" + scene_.solids[overlap.first].info.path + "' and '" +
                         scene_.solids[overlap.second].info.path + "', layer " + std::to_string(cut.layer.index) +
                         ", z = " + format_double(cut.layer.z_sample) + " mm",
                     "give one of them a higher priority, or choose another --overlap policy");
  }
}

void Tally::warn(SolidId solid, std::string what, std::string hint) {
  const SolidInfo& info = scene_.solids[solid].info;
  Finding finding;
  finding.solid = info.path;
  if (info.step_entity > 0) finding.entity = std::string("#").append(std::to_string(info.step_entity));
  finding.what = std::move(what);
  finding.hint = std::move(hint);
  report_.findings.push_back(std::move(finding));
}

void Tally::judge_solid(SolidId solid) {
  const SolidMeasure& measure = measures_[solid];
  SolidReport& out = report_.solids[solid];
  out.volume_sliced = solid_volume_[solid.value()].value();
  out.volume_exact = std::isfinite(measure.volume) ? measure.volume : 0.0;
  const double bound = plan_.grid.pitch.y() * measure.abs_normal_area.y() + thickest_ * measure.abs_normal_area.z();
  out.quadrature_bound = std::isfinite(bound) ? bound : 0.0;
  if (out.left_out) {
    warn(solid, "left out: the solid is " + out.status, "repair it, or slice it by winding number with --allow-open");
    return;
  }
  if (out.status != "ok") {
    warn(solid, "the solid is " + out.status + "; its segments can't be trusted", "repair it in the CAD system");
    return;
  }
  const double allowed = kNormalAreaSlack * out.quadrature_bound + measure.volume_error;
  if (!measure.converged) {
    warn(solid, "its exact volume is known only to " + format_double(measure.volume_error) + " mm^3",
         "compare it with the CAD system's");
  }
  if (out.volume_sliced == 0.0 && out.volume_exact > 0.0) {
    warn(solid, "no ray meets the solid: it lies between the rows and layers", "use a finer pitch or layer height");
  }
  // Written so that NaN fails.
  if (std::abs(out.volume_sliced - measure.volume) <= allowed) return;
  out.status = "volume";
  warn(solid,
       "sliced volume " + format_double(out.volume_sliced) + " mm^3 is further from the exact " +
           format_double(out.volume_exact) + " mm^3 than the quadrature bound " + format_double(out.quadrature_bound),
       "look at its layers before building it");
}

void Tally::report_overlaps() {
  report_.overlaps = pair_reports(overlaps_);
  report_.gaps = pair_reports(gaps_);
  for (const PairReport& overlap : report_.overlaps) {
    if (!is_ambiguous(overlap.first, overlap.second)) continue;
    warn(overlap.first,
         "overlaps '" + scene_.solids[overlap.second].info.path + "' of another material at equal priority by " +
             format_double(overlap.volume) + " mm^3",
         "give one of them a higher priority");
  }
}

void Tally::report_contacts() {
  const auto layers_in = [&](const Interval& z) {
    return static_cast<std::uint64_t>(
        std::count_if(plan_.layers.begin(), plan_.layers.end(),
                      [&](const LayerSpan& layer) { return layer.z_bottom <= z.hi && layer.z_top >= z.lo; }));
  };
  for (const Contact& contact : contacts_) {
    if (contact.touching_area > 0.0) {
      report_.interfaces.push_back({contact.first, contact.second, contact.touching_area, 0.0, 0.0, contact.largest_gap,
                                    layers_in(contact.touching_z)});
    }
    if (contact.gap_area > 0.0) {
      report_.open_gaps.push_back({contact.first, contact.second, contact.gap_area, contact.gap_volume,
                                   contact.least_gap, contact.widest_gap, layers_in(contact.gap_z)});
    }
    const auto gap = gaps_.find({contact.first, contact.second});
    if (gap != gaps_.end()) gap->second.largest_depth = contact.largest_gap;
  }
}

void Tally::report_casts() {
  const auto note = [&](std::uint64_t count, const char* what) {
    if (count == 0) return;
    Finding finding;
    finding.what = std::to_string(count) + what;
    finding.hint = "compare the volumes, or move the lattice by a fraction of the pitch with --origin";
    report_.findings.push_back(std::move(finding));
  };
  failed_.report(scene_, report_.findings);
  note(report_.cast.unclosed_rays, " rays could not be closed; their solid is missing there");
  note(report_.cast.repaired_rays, " rays were repaired by dropping or inventing hits");
  note(report_.cast.uncertain_hits, " hits are uncertain within the file's own tolerances");
}

void Tally::report_mixing() {
  const auto warn_of = [&](std::string what, const char* hint) {
    Finding finding;
    finding.what = std::move(what);
    finding.hint = hint;
    report_.findings.push_back(std::move(finding));
  };
  if (mixing_.repaired > 0) {
    warn_of("the fractions of graded materials were no fractions at " + std::to_string(mixing_.repaired) + " of " +
                std::to_string(mixing_.samples) + " points, by up to " + format_double(mixing_.largest_repair) +
                "; they were clamped to 0 or more and scaled to the sum 1",
            "mend the formulas or grids in the materials file");
  }
  if (mixing_.unresolved > 0) {
    warn_of(std::to_string(mixing_.unresolved) + " graded segments change too often for their knots",
            "their fractions may be off by more than 0.001; smooth the field");
  }
}

SliceReport Tally::finish() {
  for (const SolidId solid : scene_.solids.ids()) judge_solid(solid);
  for (const MaterialId material : table_.materials.ids()) {
    MaterialReport& out = report_.materials[material];
    out.volume = material_volume_[material.value()].value();
    out.mass = table_.materials[material].density.value_or(0.0) * out.volume * kGramsPerDensityVolume;
  }
  report_contacts();
  report_overlaps();
  report_casts();
  report_mixing();
  contour_findings_.report(report_.findings);
  return std::move(report_);
}

}  // namespace lamella
