#include "tests/slicing/accuracy/compare_sections.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "model/measure.h"
#include "slicing/span/span_engine.h"
#include "tests/slicing/accuracy/occt_sections.h"
#include "tests/support/occt_solids.h"
#include "tests/support/step_scenes.h"

namespace lamella::test {

double ComparedSection::difference() const { return std::abs(area - occt); }

SectionComparison compare_sections(const std::filesystem::path& file, int per_solid, double seconds,
                                   std::uint32_t seed) {
  const Scene scene = read_scene(file);
  const std::vector<TopoDS_Solid> solids = occt_solids(file);
  std::vector<SolidMeasure> measures;
  for (const SolidId id : scene.solids.ids()) measures.push_back(measure_solid(scene, id, 1e-4));
  const std::vector<int> partner = match_solids(measures, solids);
  SectionComparison out;
  std::mt19937 random(seed);
  const auto begin = std::chrono::steady_clock::now();
  for (const SolidId id : scene.solids.ids()) {
    if (!scene.solids[id].info.closed) continue;
    ++out.solids;
    out.tolerance = std::max(out.tolerance, scene.solids[id].info.max_tolerance);
    if (partner[id.value()] < 0) {
      ++out.unmatched;
      continue;
    }
    const Box3& box = measures[id.value()].bounds;
    std::vector<double> heights;
    for (int k = 0; k < per_solid; ++k) {
      heights.push_back(std::uniform_real_distribution<double>(box.min().z(), box.max().z())(random));
    }
    std::sort(heights.begin(), heights.end());
    const SpanEngine engine(scene, std::span(&id, 1), {});
    const std::vector<double> areas = engine.section_areas(id, heights);
    for (std::size_t k = 0; k < heights.size(); ++k) {
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
      if (taken.count() > seconds) return out;
      const double gap = std::max(1e-4, 4.0 * scene.solids[id].info.max_tolerance);
      const OcctSection theirs = occt_section(solids[static_cast<std::size_t>(partner[id.value()])], heights[k], gap);
      out.sections.push_back({id.value(), heights[k], areas[k], theirs.area, theirs.length, theirs.is_whole});
    }
  }
  return out;
}

}  // namespace lamella::test
