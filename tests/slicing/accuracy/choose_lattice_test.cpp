#include "slicing/accuracy/choose_lattice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "model/nearest_point.h"
#include "slicing/adaptive/adaptive_plan.h"
#include "slicing/slicer.h"
#include "tests/support/cut_scene.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

namespace lamella::accuracy {
namespace {

using ::testing::HasSubstr;

struct Model {
  Scene scene;
  IdVector<SolidId, SolidMeasure> measures;
  std::vector<SolidId> solids;
};

Model model_of(Scene scene) {
  Model model;
  model.measures = measure_solids(scene);
  model.solids = test::all_solids(scene);
  model.scene = std::move(scene);
  return model;
}

LatticeChoice choose(const Model& model, double accuracy, const Machine* machine = nullptr) {
  return choose_lattice(model.scene, model.measures, model.solids, accuracy, machine);
}

Machine jetting() { return read_machine(test::datasets_dir() / "machines/material_jetting.xml"); }
Machine nozzles() { return read_machine(test::datasets_dir() / "machines/multi_nozzle.xml"); }

LayerPlan plan_of(const Model& model, const LatticeChoice& choice) {
  Box3 bounds;
  for (const SolidId solid : model.solids) bounds.extend(model.measures[solid].bounds);
  PlanOptions options;
  options.pitch = choice.pitch.head<2>();
  options.layer_height = choice.pitch.z();
  return plan_layers(bounds, options);
}

/// Which voxels of a plan have their centre in the one solid.
class Voxels {
 public:
  Voxels(const Model& model, const LayerPlan& plan) : grid_(plan.grid) {
    borders_.push_back(plan.layers.front().z_bottom);
    for (const LayerSpan& layer : plan.layers) borders_.push_back(layer.z_top);
    const SpanEngine engine(model.scene, model.solids, {});
    std::vector<LayerRequest> requests;
    RowLattice rows;
    rows.anchor = grid_.origin.y();
    rows.spacing = grid_.pitch.y();
    rows.last_row = grid_.size[1];
    for (std::size_t k = 0; k < plan.layers.size(); ++k) requests.push_back({k, plan.layers[k].z_sample, {rows}});
    inside_.resize(static_cast<std::size_t>(grid_.size[0] * grid_.size[1] * grid_.size[2]));
    const std::vector<LayerSpans> layers = test::cut_layers(engine, requests);
    for (std::int64_t k = 0; k < grid_.size[2]; ++k) {
      for (std::int64_t j = 0; j < grid_.size[1]; ++j) fill_row(layers[k].lattices[0].row(j), j, k);
    }
  }

  [[nodiscard]] double row_volume() const { return section_ * grid_.pitch.y(); }

  /// Calls visit(corner) for the corners of all sides between a voxel inside and one outside.
  template <class Visit>
  void for_each_boundary_corner(const Visit& visit) const {
    for (std::int64_t k = -1; k < grid_.size[2]; ++k) {
      for (std::int64_t j = -1; j < grid_.size[1]; ++j) {
        for (std::int64_t i = -1; i < grid_.size[0]; ++i) visit_sides({i, j, k}, visit);
      }
    }
  }

 private:
  using Index = std::array<std::int64_t, 3>;

  void fill_row(std::span<const Span> spans, std::int64_t j, std::int64_t k) {
    const auto layer = static_cast<std::size_t>(k);
    for (const Span& span : spans) {
      section_ += (span.end - span.begin) * (borders_[layer + 1] - borders_[layer]);
      for (std::int64_t i = 0; i < grid_.size[0]; ++i) {
        const double x = grid_.origin.x() + (static_cast<double>(i) + 0.5) * grid_.pitch.x();
        if (span.begin <= x && x < span.end) inside_[number({i, j, k})] = 1;
      }
    }
  }
  [[nodiscard]] std::size_t number(const Index& v) const {
    return static_cast<std::size_t>((v[2] * grid_.size[1] + v[1]) * grid_.size[0] + v[0]);
  }
  [[nodiscard]] bool is_inside(const Index& v) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (v[axis] < 0 || v[axis] >= grid_.size[axis]) return false;
    }
    return inside_[number(v)] != 0;
  }

  template <class Visit>
  void visit_sides(const Index& voxel, const Visit& visit) const {
    for (int axis = 0; axis < 3; ++axis) {
      Index next = voxel;
      ++next[static_cast<std::size_t>(axis)];
      if (is_inside(voxel) == is_inside(next)) continue;
      for (int corner = 0; corner < 4; ++corner) {
        Vec3 steps(static_cast<double>(next[0]), static_cast<double>(next[1]), static_cast<double>(next[2]));
        if ((corner & 1) != 0) steps[(axis + 1) % 3] += 1.0;
        if ((corner & 2) != 0) steps[(axis + 2) % 3] += 1.0;
        Vec3 at = grid_.origin + steps.cwiseProduct(grid_.pitch);
        at.z() = borders_[static_cast<std::size_t>(steps.z())];
        visit(at);
      }
    }
  }

  Grid grid_;
  std::vector<double> borders_;  // of layers
  double section_ = 0.0;         // mm^2, of the rows over their layers
  std::vector<char> inside_;
};

/// Slices and holds what is guaranteed against the exact surface.
void expect_kept(const Model& model, const LatticeChoice& choice, const LayerPlan& plan) {
  EXPECT_LE(choice.surface_bound, choice.wanted * (1.0 + 1e-12));
  const Voxels voxels(model, plan);
  const SolidMeasure& measure = model.measures[SolidId{0}];
  EXPECT_LE(std::abs(voxels.row_volume() - measure.volume), choice.offset_bound * measure.area);
  const NearestPoint nearest(model.scene, faces_of(model.scene, SolidId{0}));
  double farthest = 0.0;
  voxels.for_each_boundary_corner(
      [&](const Vec3& corner) { farthest = std::max(farthest, nearest.find(corner)->distance); });
  EXPECT_LE(farthest, choice.surface_bound + 1e-6);
  EXPECT_GT(farthest, 0.4 * choice.surface_bound);  // the bound is no idle one
}

void expect_kept(const Model& model, const LatticeChoice& choice) {
  EXPECT_LE(choice.offset_bound, choice.wanted * (1.0 + 1e-12));
  expect_kept(model, choice, plan_of(model, choice));
}

/// The same with adaptive layers.
void expect_kept_adaptively(const Model& model, double accuracy, std::optional<double> deviation) {
  const AdaptiveShare share = share_accuracy(accuracy, deviation, nullptr);
  Box3 bounds;
  for (const SolidId solid : model.solids) bounds.extend(model.measures[solid].bounds);
  PlanOptions options;
  options.pitch = share.pitch;
  LayerPlan plan = plan_layers(bounds, options);
  MaterialTable table;
  table.materials.push_back({"Resin", std::nullopt});
  for (std::size_t s = 0; s < model.scene.solids.size(); ++s) table.assignments.push_back({MaterialId{0}, 0, "test"});
  AdaptiveOptions layers;
  layers.deviation = share.deviation;
  const AdaptivePlan adaptive =
      plan_adaptive_layers(model.scene, table, model.measures, model.solids, plan.grid.origin.z(), layers);
  set_layers(plan, adaptive.layers);
  double thickest = 0.0;
  for (const LayerSpan& layer : plan.layers) thickest = std::max(thickest, layer.z_top - layer.z_bottom);
  expect_kept(model,
              adaptive_guarantee(model.scene, model.measures, model.solids, accuracy, share.pitch, thickest,
                                 adaptive.largest_deviation),
              plan);
}

TEST(ChooseLattice, SharesAnAccuracyWithAdaptiveLayers) {
  expect_kept_adaptively(model_of(test::scene_of(test::add_sphere, 2.0)), 0.15, std::nullopt);
  expect_kept_adaptively(model_of(test::scene_of(test::add_torus, 2.0, 0.7)), 0.11, 0.03);
}

TEST(ChooseLattice, GivesAdaptiveLayersHalfOfTheAccuracyOrWhatTheMachineLeaves) {
  const AdaptiveShare half = share_accuracy(0.05, std::nullopt, nullptr);
  EXPECT_DOUBLE_EQ(half.deviation, 0.025);
  EXPECT_DOUBLE_EQ(half.pitch.x(), 0.035);  // 0.025 times the root of 2, down
  EXPECT_DOUBLE_EQ(share_accuracy(0.05, 0.04, nullptr).pitch.y(), 0.014);
  const Machine machine = jetting();  // half the diagonal of its pixel is 0.04733
  const AdaptiveShare rest = share_accuracy(0.06, std::nullopt, &machine);
  EXPECT_EQ(rest.pitch, machine.pitch);
  EXPECT_DOUBLE_EQ(rest.deviation, 0.012);
  EXPECT_DOUBLE_EQ(share_accuracy(0.06, 0.01, &machine).deviation, 0.01);
}

TEST(ChooseLattice, SaysWhenAnAccuracyLeavesNothingToPitchOrLayers) {
  const Machine machine = jetting();
  const auto hint = [&](double accuracy, std::optional<double> deviation, const Machine* on) -> std::string {
    try {
      (void)share_accuracy(accuracy, deviation, on);
      return "";
    } catch (const UsageError& error) {
      return std::string(error.what()) + " | " + error.where() + " | " + error.hint();
    }
  };
  EXPECT_THAT(hint(0.05, 0.05, nullptr), HasSubstr("| --adaptive | give less than --accuracy"));
  EXPECT_THAT(hint(0.04, std::nullopt, &machine), HasSubstr("| --accuracy | its pitch alone takes 0.047331 mm"));
  EXPECT_THAT(hint(0.06, 0.02, &machine), HasSubstr("| --adaptive | with its pitch they reach 0.067331 mm"));
  EXPECT_THAT(hint(0.0, std::nullopt, nullptr), HasSubstr("positive"));
}

TEST(ChooseLattice, KeepsVoxelsOfABallAsCloseAsAsked) {
  const Model model = model_of(test::scene_of(test::add_sphere, 2.0));
  expect_kept(model, choose(model, 0.15));
}

TEST(ChooseLattice, KeepsVoxelsOfATorusAsCloseAsAsked) {
  const Model model = model_of(test::scene_of(test::add_torus, 2.0, 0.7));
  expect_kept(model, choose(model, 0.11));
}

TEST(ChooseLattice, TakesEqualPitchesOfTwoDigits) {
  // On a ball A_y = A_z = A / 2: its volume allows a pitch of T / 1.01, its surface 1.15 T.
  const LatticeChoice ball = choose(model_of(test::scene_of(test::add_sphere, 2.0)), 0.01);
  EXPECT_DOUBLE_EQ(ball.pitch.x(), 0.0099);
  EXPECT_EQ(ball.pitch, Vec3::Constant(ball.pitch.x()));
  // A rod along x shows all of its area to y and z: they get 4/5 of it by Cauchy's mean 2/pi each.
  const Model rod = model_of([] {
    Scene scene;
    test::SolidOptions options;
    options.placement = test::Placement::turned(Vec3::UnitY(), kPi / 2.0);
    test::add_cylinder(scene, 0.1, 100.0, options);
    return scene;
  }());
  EXPECT_DOUBLE_EQ(choose(rod, 1.0).pitch.x(), 0.77);  // pi / 4 / 1.01, down
  EXPECT_DOUBLE_EQ(choose(rod, 130.0).pitch.x(), 100.0);
}

TEST(ChooseLattice, OnAMachineTheRasterStaysAndLayersAreItsThickest) {
  const Model ball = model_of(test::scene_of(test::add_sphere, 2.0));
  const Machine machine = jetting();
  const LatticeChoice coarse = choose(ball, 1.0, &machine);
  EXPECT_EQ(coarse.pitch.head<2>(), machine.pitch);
  EXPECT_DOUBLE_EQ(coarse.pitch.z(), 0.027);
  // Volume: 1.01 / 2 times the sum of 0.0847 (300 dpi) and the layer: 0.0496 with the thinner one, 0.0564 with the
  // other.
  const LatticeChoice fine = choose(ball, 0.0497, &machine);
  EXPECT_DOUBLE_EQ(fine.pitch.z(), 0.0135);
  EXPECT_LE(fine.offset_bound, 0.0497);
  const Machine other = nozzles();
  for (const double accuracy : {0.3, 0.25, 0.22}) {
    const LatticeChoice choice = choose(ball, accuracy, &other);
    EXPECT_TRUE(layer_height_fault(other, choice.pitch.z()).empty()) << choice.pitch.z();
    EXPECT_LE(choice.surface_bound, accuracy);
    EXPECT_LE(choice.offset_bound, accuracy);
    // The next height that the machine builds would be too much, or there is none.
    LatticeChoice next = choice;
    next.pitch.z() += 1e-6;  // it builds any height
    EXPECT_TRUE(!layer_height_fault(other, next.pitch.z()).empty() || 0.5 * next.pitch.norm() > accuracy ||
                0.505 * (next.pitch.y() + next.pitch.z()) > accuracy);
  }
}

TEST(ChooseLattice, AMachineThatCantReachItSaysWhatItReaches) {
  const Model ball = model_of(test::scene_of(test::add_sphere, 2.0));
  const Machine machine = jetting();
  try {
    (void)choose(ball, 0.01, &machine);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.hint(), HasSubstr("0.049575 mm"));
  }
  EXPECT_NO_THROW((void)choose(ball, 0.049575, &machine));
}

TEST(ChooseLattice, NonsenseIsRefused) {
  const Model ball = model_of(test::scene_of(test::add_sphere, 2.0));
  for (const double accuracy : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)choose(ball, accuracy), UsageError);
  }
}

TEST(ChooseLattice, StatesTheFilesOwnTolerance) {
  Scene scene = test::scene_of(test::add_sphere, 2.0);
  scene.solids[SolidId{0}].info.max_tolerance = 0.02;
  EXPECT_EQ(choose(model_of(std::move(scene)), 0.01).file_tolerance, 0.02);
}

}  // namespace
}  // namespace lamella::accuracy
