#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "core/error.h"
#include "model/evaluate.h"
#include "model/trim.h"
#include "slicing/adaptive/adaptive_plan.h"
#include "tests/support/solids.h"
#include "tests/support/step_scenes.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;

/// Every solid its own material, or all the same.
MaterialTable table_for(const Scene& scene, bool one_each = false) {
  MaterialTable table;
  if (!one_each) table.materials.push_back({"Resin", std::nullopt});
  for (std::size_t s = 0; s < scene.solids.size(); ++s) {
    if (one_each) table.materials.push_back({"M" + std::to_string(s), std::nullopt});
    table.assignments.push_back({MaterialId{one_each ? s : 0}, 0, "test"});
  }
  return table;
}

std::vector<SolidId> all_solids(const Scene& scene) {
  std::vector<SolidId> solids;
  for (const SolidId id : scene.solids.ids()) solids.push_back(id);
  return solids;
}

double lowest(const IdVector<SolidId, SolidMeasure>& measures) {
  double z = std::numeric_limits<double>::infinity();
  for (const SolidMeasure& measure : measures) z = std::min(z, measure.bounds.min().z());
  return z;
}

ModelSlants slants_of(const Scene& scene, double width, double bottom, std::size_t count) {
  const auto measures = measure_solids(scene);
  return find_slants(scene, table_for(scene), measures, all_solids(scene), {bottom, width, count},
                     IdVector<MaterialId, WedgeRule>(1, {}));
}

AdaptivePlan plan_of(const Scene& scene, const MaterialTable& table, const AdaptiveOptions& options) {
  const auto measures = measure_solids(scene);
  return plan_adaptive_layers(scene, table, measures, all_solids(scene), lowest(measures), options);
}

SolidOptions moved(const Vec3& by) {
  SolidOptions options;
  options.placement = Placement::at(by);
  return options;
}

AdaptiveOptions options_of(double deviation, double least, double most, double step) {
  AdaptiveOptions options;
  options.deviation = deviation;
  options.range = Interval{least, most};
  options.step = step;
  return options;
}

TEST(SlantProfile, AddsWhatTheDistanceGrowsBy) {
  SlantProfile profile(10.0, 0.5, 8);
  profile.add({{10.0, 11.0}, 0.2});
  profile.add({{11.0, 12.0}, 0.6});
  profile.add({{13.25, 13.25}, 1.0});
  profile.finish();
  EXPECT_DOUBLE_EQ(profile.slant(1), 0.2);
  EXPECT_DOUBLE_EQ(profile.slant(2), 0.6);
  EXPECT_DOUBLE_EQ(profile.slant(6), 1.0);
  // Up from 11 through the steep part; down from 11 only the other.
  EXPECT_NEAR(profile.layer_deviation(0, 4), 0.6, 1e-8);
  // From 12 up: nothing until 13.25, then everything up to 14; down from 12 all is 0.6.
  EXPECT_NEAR(profile.layer_deviation(0, 8), std::max(0.75, 0.6 * 2.0), 1e-8);
  EXPECT_NEAR(profile.layer_deviation(4, 8), 0.75, 1e-8);
  // A layer that ends at the level doesn't feel it, but by rounding.
  SlantProfile flat(0.0, 0.5, 4);
  flat.add({{1.0 + 1e-13, 1.0 + 1e-13}, 1.0});
  flat.finish();
  EXPECT_NEAR(flat.layer_deviation(0, 2), 0.0, 1e-8);
  EXPECT_NEAR(flat.layer_deviation(2, 4), 0.0, 1e-8);
  EXPECT_NEAR(flat.layer_deviation(0, 4), 1.0, 1e-8);
}

TEST(Slants, OfASphereAreThoseOfItsNormals) {
  const double radius = 5.0;
  const double width = 0.05;
  const Scene scene = scene_of(add_sphere, radius);
  const ModelSlants slants = slants_of(scene, width, -radius, 200);
  const SlantProfile& profile = *slants.profiles[MaterialId{0}];
  for (std::size_t bin = 0; bin < 200; ++bin) {
    const double low = std::abs(-radius + static_cast<double>(bin) * width);
    const double high = std::abs(-radius + static_cast<double>(bin + 1) * width);
    const double exact = std::min(1.0, std::max(low, high) / radius);
    EXPECT_GE(profile.slant(bin), exact - 1e-9) << bin;
    EXPECT_LE(profile.slant(bin), exact + 0.03) << bin;
  }
  ASSERT_EQ(slants.features.size(), 2U);
  EXPECT_NEAR(slants.features[0].z, -radius, 1e-9);
  EXPECT_NEAR(slants.features[1].z, radius, 1e-9);
}

TEST(Slants, OfUprightWallsAreNoneAndFlatEndsAreFeatures) {
  const Scene scene = scene_of(add_cylinder, 3.0, 4.0);
  const ModelSlants slants = slants_of(scene, 0.1, 0.0, 42);
  const SlantProfile& profile = *slants.profiles[MaterialId{0}];
  for (std::size_t bin = 1; bin < 39; ++bin) EXPECT_LE(profile.slant(bin), 1e-7) << bin;
  EXPECT_LE(profile.layer_deviation(0, 40), 1e-6);
  EXPECT_NEAR(profile.layer_deviation(0, 42), 0.2, 1e-6);
  ASSERT_EQ(slants.features.size(), 2U);
  EXPECT_EQ(slants.features[0].kind, FlatKind::face);
  EXPECT_EQ(slants.features[1].kind, FlatKind::face);
}

TEST(Slants, OfAFrustumAreThatOfItsWall) {
  const Scene scene = scene_of(add_frustum, 4.0, 1.0, 6.0);
  const ModelSlants slants = slants_of(scene, 0.1, 0.0, 60);
  const SlantProfile& profile = *slants.profiles[MaterialId{0}];
  const double exact = 3.0 / std::hypot(3.0, 6.0);
  for (std::size_t bin = 1; bin < 59; ++bin) EXPECT_NEAR(profile.slant(bin), exact, 0.01) << bin;
}

// A cube on its corner: faces have |n_z| = 1/sqrt(3), but around an edge between two upper faces the normals reach
// sqrt(2/3), and around the lowest and the highest corner the vertical.
TEST(Slants, CountWhatLiesBetweenTheNormalsAtEdges) {
  SolidOptions options;
  const Vec3 axis = Vec3(1.0, -1.0, 0.0).normalized();
  options.placement = Placement::turned(axis, -std::acos(1.0 / std::sqrt(3.0)));
  Scene scene;
  add_box(scene, Vec3::Zero(), Vec3::Constant(3.0), options);
  const auto measures = measure_solids(scene);
  const double bottom = measures[SolidId{0}].bounds.min().z();
  const double top = measures[SolidId{0}].bounds.max().z();
  ASSERT_NEAR(top - bottom, 3.0 * std::sqrt(3.0), 1e-9);
  const ModelSlants slants = slants_of(scene, 0.01, bottom, 520);
  const SlantProfile& profile = *slants.profiles[MaterialId{0}];
  // Upper edges from two thirds of the height on, lower ones up to a third; in between edges join an upper and a lower
  // face and what lies between their normals is less slanted than they are.
  EXPECT_NEAR(profile.slant(50), std::sqrt(2.0 / 3.0), 0.01);
  EXPECT_NEAR(profile.slant(470), std::sqrt(2.0 / 3.0), 0.01);
  EXPECT_NEAR(profile.slant(260), 1.0 / std::sqrt(3.0), 0.01);
}

// A frustum has a wedge all round the rim of its larger end: the end looks one way, the wall the other.
TEST(Slants, CountTheTipsOfWedgesAllRoundARim) {
  const auto layers = [](double r0, double r1) {
    const Scene scene = scene_of(add_frustum, r0, r1, 6.0);
    // Walls of 45 degrees: 0.05 by the sine lets layers have 0.14 mm, by the tangent 0.1 mm.
    return plan_of(scene, table_for(scene), options_of(0.05, 0.02, 0.4, 0.02)).layers;
  };
  const auto foot = layers(8.0, 2.0);
  EXPECT_LE(foot.front().z_top - foot.front().z_bottom, 0.1 + 1e-9);
  EXPECT_NEAR(foot[foot.size() / 2].z_top - foot[foot.size() / 2].z_bottom, 0.14, 1e-9);
  const auto head = layers(2.0, 8.0);
  EXPECT_LE(head.back().z_top - head.back().z_bottom, 0.1 + 1e-9);
}

class SlantsOfFiles : public ::testing::TestWithParam<std::filesystem::path> {};

// Normals by the evaluator at random places inside the faces are never above the profile.
TEST_P(SlantsOfFiles, BoundTheNormalsOfRandomPoints) {
  const Scene scene = read_scene(GetParam());
  const auto measures = measure_solids(scene);
  const double bottom = lowest(measures);
  double top = bottom;
  for (const SolidMeasure& measure : measures) top = std::max(top, measure.bounds.max().z());
  constexpr std::size_t kBins = 500;
  const double width = (top - bottom) / kBins;
  const ModelSlants slants = slants_of(scene, width, bottom, kBins);
  const SlantProfile& profile = *slants.profiles[MaterialId{0}];
  std::mt19937 random(3);
  std::size_t looked_at = 0;
  double excess = 0.0;
  for (const FaceId id : scene.faces.ids()) {
    const Face& face = scene.faces[id];
    const TrimRegion region(scene, id);
    for (int k = 0; k < 40; ++k) {
      const auto share = [&] { return std::uniform_real_distribution<double>(0.0, 1.0)(random); };
      const Vec2 uv = face.uv_bounds.min() + Vec2(share(), share()).cwiseProduct(face.uv_bounds.sizes());
      if (region.classify(uv) != TrimRegion::Side::inside) continue;
      const SurfacePoint at = evaluate(face.surface, uv);
      const double length = at.normal().norm();
      if (!(length > 1e-9 * (at.du.squaredNorm() + at.dv.squaredNorm()))) continue;
      const double bin = (at.point.z() - bottom) / width;
      // Within a millionth of a border, or level: rounding decides about the bin.
      if (bin < 0.0 || bin >= kBins || std::abs(bin - std::round(bin)) < 1e-4) continue;
      ++looked_at;
      excess = std::max(excess, std::abs(at.normal().z()) / length - profile.slant(static_cast<std::size_t>(bin)));
    }
  }
  EXPECT_GT(looked_at, 10U);
  EXPECT_LE(excess, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(DataSets, SlantsOfFiles, ::testing::ValuesIn(dataset_files()),
                         [](const auto& file) { return test_name(file.param); });

TEST(AdaptivePlan, KeepsTheToleranceOfASphereWithFewerLayers) {
  const Scene scene = scene_of(add_sphere, 5.0);
  const AdaptivePlan plan = plan_of(scene, table_for(scene), options_of(0.05, 0.04, 0.4, 0.02));
  EXPECT_LE(plan.largest_deviation, 0.05 + 1e-9);
  EXPECT_DOUBLE_EQ(plan.layers.front().z_bottom, -5.0);
  EXPECT_NEAR(plan.layers.back().z_top, 5.0, 0.01 + 1e-9);
  for (std::size_t k = 0; k < plan.layers.size(); ++k) {
    const LayerSpan& layer = plan.layers[k];
    if (k > 0) {
      EXPECT_EQ(layer.z_bottom, plan.layers[k - 1].z_top);
    }
    EXPECT_DOUBLE_EQ(layer.z_sample, 0.5 * (layer.z_bottom + layer.z_top));
    const double quanta = (layer.z_top - layer.z_bottom) / plan.quantum;
    EXPECT_NEAR(quanta, std::round(quanta), 1e-6);
    EXPECT_LE(layer.z_top - layer.z_bottom, 0.4 + 1e-9);
  }
  ASSERT_TRUE(plan.uniform_layers && plan.greedy_layers);
  EXPECT_LT(plan.layers.size(), *plan.uniform_layers);
  EXPECT_LE(plan.layers.size(), *plan.greedy_layers);
  EXPECT_EQ(plan.missed, 0U);
}

TEST(AdaptivePlan, EndsLayersAtFlatFaces) {
  Scene scene;
  add_box(scene, Vec3(0, 0, 0), Vec3(9, 9, 1.03));
  add_box(scene, Vec3(20, 0, 0), Vec3(29, 9, 2.517));
  const AdaptivePlan plan = plan_of(scene, table_for(scene), options_of(0.05, 0.1, 0.5, 0.02));
  EXPECT_EQ(plan.missed, 0U);
  ASSERT_EQ(plan.features.size(), 3U);
  for (const MetFeature& met : plan.features) EXPECT_LE(std::abs(met.offset), 0.01 + 1e-9) << met.feature.z;
  EXPECT_NEAR(std::abs(plan.features[1].offset), 0.01, 1e-9);  // in the middle between two borders
  // 1.02 or 1.04 by three layers, the rest by three of at most 0.5.
  EXPECT_EQ(plan.layers.size(), 6U);
}

// Layers of 0.3 to 0.5 mm in steps of 0.1: a face at 0.95 is as near to 0.9 as to 1.0, and two layers reach both.
TEST(AdaptivePlan, SpendsNoLayerOnAFaceInTheMiddleBetweenTwoBorders) {
  const auto layers_for = [](double first, double second) {
    Scene scene;
    add_box(scene, Vec3(0, 0, 0), Vec3(9, 9, first));
    add_box(scene, Vec3(20, 0, 0), Vec3(29, 9, second));
    const AdaptivePlan plan = plan_of(scene, table_for(scene), options_of(0.1, 0.3, 0.5, 0.1));
    EXPECT_EQ(plan.missed, 0U);
    EXPECT_LE(plan.largest_deviation, 0.1 + 1e-9);
    return plan.layers.size();
  };
  EXPECT_EQ(layers_for(0.95, 1.9), layers_for(1.0, 1.9));
  EXPECT_EQ(layers_for(0.45, 1.4), 3U);   // 0.4 or 0.5, then 1.0 or 0.9 by two
  EXPECT_EQ(layers_for(1.05, 2.0), 4U);   // by way of 1.0, not of 1.1
  EXPECT_EQ(layers_for(0.55, 1.05), 2U);  // the top too, and by way of 0.5 rather than 0.6
}

TEST(AdaptivePlan, SaysWhichFlatFacesItMisses) {
  Scene scene;
  add_box(scene, Vec3(0, 0, 0), Vec3(9, 9, 3));
  add_box(scene, Vec3(20, 0, 0), Vec3(29, 9, 3.06));
  const AdaptivePlan plan = plan_of(scene, table_for(scene), options_of(0.1, 0.1, 0.5, 0.02));
  EXPECT_EQ(plan.missed, 1U);
  EXPECT_LE(plan.largest_deviation, 0.1 + 1e-9);
}

TEST(AdaptivePlan, KeepsEachMaterialsOwnTolerance) {
  Scene scene;
  add_sphere(scene, 5.0, moved({0, 0, 0}));
  add_sphere(scene, 5.0, moved({20, 0, 0}));
  MaterialTable table = table_for(scene, true);
  const AdaptiveOptions options = options_of(0.1, 0.02, 0.4, 0.01);
  const AdaptivePlan loose = plan_of(scene, table, options);
  table.materials[MaterialId{1}].layers.deviation = 0.03;
  const AdaptivePlan strict = plan_of(scene, table, options);
  EXPECT_GT(loose.materials[MaterialId{1}].largest, 0.05);
  EXPECT_LE(strict.materials[MaterialId{1}].largest, 0.03 + 1e-9);
  EXPECT_GT(strict.layers.size(), loose.layers.size());
}

/// What the call is refused with.
template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return std::to_string(static_cast<int>(error.code())) + ": " + error.what() + " (" + error.where() + "); " +
           error.hint();
  }
  return "nothing";
}

TEST(AdaptivePlan, NamesTheTwoMaterialsThatClashAndWhere) {
  Scene scene;
  add_box(scene, Vec3(0, 0, 0), Vec3(9, 9, 10));
  add_box(scene, Vec3(20, 0, 4), Vec3(29, 9, 10), moved({0, 0, 0}));
  MaterialTable table = table_for(scene, true);
  table.materials[MaterialId{0}].name = "Thick";
  table.materials[MaterialId{0}].layers.least = 0.3;
  table.materials[MaterialId{1}].name = "Thin";
  table.materials[MaterialId{1}].layers.most = 0.2;
  const std::string said = refusal([&] { (void)plan_of(scene, table, options_of(0.5, 0.1, 0.5, 0.1)); });
  EXPECT_THAT(said, HasSubstr("2: no layer suits the materials 'Thick' and 'Thin' from z = 4 mm on"));
  EXPECT_THAT(said, HasSubstr("'Thick' takes 0.3 to 0.5 mm"));
  EXPECT_THAT(said, HasSubstr("'Thin' takes 0.1 to 0.2 mm"));
}

TEST(AdaptivePlan, NamesTheMaterialWhoseToleranceCantBeKept) {
  const Scene scene = scene_of(add_sphere, 5.0);
  const std::string said = refusal([&] { (void)plan_of(scene, table_for(scene), options_of(0.01, 0.1, 0.5, 0.1)); });
  EXPECT_THAT(said, HasSubstr("2: no layer suits the material 'Resin' from z = -5 mm on"));
  EXPECT_THAT(said, HasSubstr("with 0.01 mm allowed"));
}

TEST(AdaptivePlan, RefusesNumbersThatMakeNoSense) {
  const Scene scene = scene_of(add_sphere, 5.0);
  const MaterialTable table = table_for(scene);
  const auto said = [&](const AdaptiveOptions& options) {
    return refusal([&] { (void)plan_of(scene, table, options); });
  };
  for (const double deviation : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(said(options_of(deviation, 0.1, 0.5, 0.1)), HasSubstr("1: the largest deviation must be positive"));
  }
  EXPECT_THAT(said(options_of(0.1, 0.5, 0.1, 0.1)), HasSubstr("is more than the largest"));
  EXPECT_THAT(said(options_of(0.1, std::nan(""), 0.1, 0.1)), HasSubstr("must be positive"));
  EXPECT_THAT(said(options_of(0.1, 0.1, 0.5, 0.0)), HasSubstr("the thickness step must be positive"));
  EXPECT_THAT(said(options_of(0.1, 0.11, 0.14, 0.1)), HasSubstr("no thickness is left"));
  EXPECT_THAT(said(options_of(0.1, 1e-5, 5e-5, 1e-6)), HasSubstr("too many layers to choose from"));
  MaterialTable narrow = table;
  narrow.materials[MaterialId{0}].layers.least = 0.6;
  EXPECT_THAT(refusal([&] { (void)plan_of(scene, narrow, options_of(0.5, 0.1, 0.5, 0.1)); }),
              HasSubstr("2: no layer suits the material 'Resin'"));
}

TEST(AdaptivePlan, DoesntDependOnThreadsAndCanBeCancelled) {
  const Scene scene = scene_of(add_dome, 8.0, 6.0, 2.0, 3.0);
  const auto measures = measure_solids(scene);
  const AdaptiveOptions options = options_of(0.03, 0.02, 0.3, 0.01);
  std::vector<AdaptivePlan> plans;
  for (const int threads : {1, 2}) {
    plans.push_back(
        plan_adaptive_layers(scene, table_for(scene), measures, all_solids(scene), 0.0, options, {}, threads));
  }
  ASSERT_EQ(plans[0].layers.size(), plans[1].layers.size());
  for (std::size_t k = 0; k < plans[0].layers.size(); ++k) {
    EXPECT_EQ(plans[0].layers[k].z_top, plans[1].layers[k].z_top);
    EXPECT_EQ(plans[0].deviations[k], plans[1].deviations[k]);
  }
  const std::atomic<bool> cancel{true};
  EXPECT_THROW((void)plan_adaptive_layers(scene, table_for(scene), measures, all_solids(scene), 0.0, options,
                                          Progress({}, &cancel)),
               Cancelled);
}

}  // namespace
}  // namespace lamella::test
