/// A few rays against OpenCASCADE; the long comparison is compare_with_occt.

#include "tests/slicing/reference/occt_comparison.h"

#include <gtest/gtest.h>

#include "tests/support/paths.h"

namespace lamella::test {
namespace {

void expect_agreement(const std::string& name, int rays) {
  const OcctComparison comparison = compare_with_occt(corpus_dir() / name, rays, 5);
  ASSERT_GT(comparison.rays, 0U) << name;
  EXPECT_GT(comparison.met, comparison.rays / 4) << name;
  EXPECT_GE(static_cast<double>(comparison.agreed), 0.995 * static_cast<double>(comparison.rays)) << name;
  EXPECT_EQ(comparison.counters.repaired_rays + comparison.counters.unclosed_rays, 0U) << name;
  for (const Dispute& dispute : comparison.disputes) {
    EXPECT_NE(dispute.verdict, Verdict::occt)
        << name << " solid " << dispute.solid.value() << ", " << kind_name(dispute.kind) << " over " << dispute.length
        << " mm, ray from " << dispute.ray.origin.transpose() << " along " << dispute.ray.direction.transpose();
  }
}

TEST(OcctComparison, AnalyticAssemblyAgrees) {
  LAMELLA_NEEDS_CORPUS();
  expect_agreement("asm_asitus_mechanism_example.stp", 400);
  expect_agreement("asm_pocc_eight_cyl.stp", 200);
}

TEST(OcctComparison, ToriAndNestedSolidsAgree) {
  LAMELLA_NEEDS_CORPUS();
  expect_agreement("free_geouned_doblecodo.stp", 300);
  expect_agreement("free_geouned_torus.stp", 500);
}

TEST(OcctComparison, FreeFormSurfacesAgree) {
  LAMELLA_NEEDS_CORPUS();
  expect_agreement("mech_elmer_bent_waveguide.step", 300);
  expect_agreement("fusion_nw_blanket.stp", 60);
}

TEST(OcctComparison, MachinedPartAgrees) {
  LAMELLA_NEEDS_CORPUS();
  expect_agreement("mech_trimesh_featuretype.step", 200);
}

}  // namespace
}  // namespace lamella::test
