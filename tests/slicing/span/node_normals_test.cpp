/// What the check of fronts against backs compares arcs with: a normal at every node, right for arcs of every kind, and
/// a finding where a face is turned.

#include <gtest/gtest.h>

#include "slicing/span/arc_balance.h"
#include "slicing/span/face_section.h"
#include "tests/support/cut_scene.h"
#include "tests/support/solids.h"
#include "tests/support/spline_form.h"

namespace lamella::span {
namespace {

using test::Placement;

/// Arcs that begin and end in a node of the solid, over all faces and layers.
struct Arcs {
  std::size_t with_normals = 0;
  std::size_t without = 0;
  std::size_t told_apart = 0;  ///< fail the check with their normals turned
};

void look_at(const Section& section, Arcs& arcs) {
  for (SectionArc arc : section.arcs) {
    if (arc.begin == arc.end) continue;
    if (arc.begin_normal.isZero(0.0) || arc.end_normal.isZero(0.0)) {
      ++arcs.without;
      continue;
    }
    ++arcs.with_normals;
    bool turned_passes = true;
    for (const double angle : {0.05, 0.8, 1.6, 2.4, 3.3}) {
      const RowLattice lattice = test::make_lattice(angle, 0.0, 0.1, 10);
      EXPECT_TRUE(keeps_balance(arc, section, lattice, 1e-6)) << "face " << arc.face.value() << " angle " << angle;
      SectionArc turned = arc;
      turned.begin_normal *= -1.0;
      turned.end_normal *= -1.0;
      turned_passes = turned_passes && keeps_balance(turned, section, lattice, 1e-6);
    }
    if (!turned_passes) ++arcs.told_apart;
  }
}

Arcs arcs_of(const Scene& scene) {
  const SolidId solid{0};
  const EdgePieces edges(scene, solid);
  const Box3 box = test::solid_box(scene, solid);
  std::vector<double> heights;
  for (std::size_t k = 0; k < kSlabLayers; ++k) {
    heights.push_back(box.min().z() + (static_cast<double>(k) + 0.37) / kSlabLayers * box.sizes().z());
  }
  Arcs arcs;
  for (const FaceId face : scene.faces.ids()) {
    const FaceModel model(scene, face, edges);
    if (model.events.empty()) continue;
    FaceSection cutter(scene, model, edges, {}, heights);
    NodeTable nodes(edges);
    for (std::size_t k = 0; k < heights.size(); ++k) {
      Section section;
      nodes.start_layer(heights[k]);
      cutter.cut(k, nodes, section);
      look_at(section, arcs);
    }
  }
  return arcs;
}

test::SolidOptions tilted() {
  return {Placement::turned(Vec3(1, 2, 3).normalized(), 0.7, Vec3(0.1, 0.2, 0.3)), "solid", "", {}};
}

void expect_normals(const Scene& scene) {
  const Arcs arcs = arcs_of(scene);
  EXPECT_GT(arcs.with_normals, 10U);
  EXPECT_EQ(arcs.told_apart, arcs.with_normals);
  // Only straight arcs that lead from a node to an arc's end have none.
  EXPECT_LE(10 * arcs.without, arcs.with_normals);
}

TEST(NodeNormals, AreThereOnPlanesAndRoundSections) {
  Scene box;
  test::add_box(box, Vec3(-4, -3, -2), Vec3(4, 3, 2), tilted());
  expect_normals(box);
  Scene cylinder;
  test::add_cylinder(cylinder, 2.0, 5.0, tilted());
  expect_normals(cylinder);
}

TEST(NodeNormals, AreThereOnTracedFacesAndInSheets) {
  for (const bool spline : {false, true}) {
    Scene cone;
    test::add_cone(cone, 2.0, 5.0, tilted());
    expect_normals(spline ? test::as_splines(cone) : cone);
    Scene cylinder;
    test::add_cylinder(cylinder, 2.0, 5.0, tilted());
    if (spline) expect_normals(test::as_splines(cylinder));
  }
}

TEST(NodeNormals, TellTheEngineOfAFaceWithTheWrongSense) {
  Scene scene;
  test::add_box(scene, Vec3(-4, -3, -2), Vec3(4, 3, 2), tilted());
  const FaceId face{2};
  scene.faces[face].same_sense = !scene.faces[face].same_sense;
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  const Box3 bounds = test::solid_box(scene, SolidId{0});
  const RowLattice lattice = test::lattice_over(bounds, 0.4, 50);
  const std::vector<LayerSpans> layers = test::cut_layers(engine, {{0, bounds.center().z(), {lattice}}});
  ASSERT_EQ(layers[0].failed.size(), 1U);
  EXPECT_EQ(layers[0].failed[0].check, Check::balance);
  EXPECT_EQ(layers[0].failed[0].face, face);
  EXPECT_EQ(layers[0].cast.uncertain_hits, layers[0].failed[0].count);
}

}  // namespace
}  // namespace lamella::span
