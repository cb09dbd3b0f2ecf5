#include "model/topology.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "model/measure.h"
#include "tests/support/solid_builder.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

using test::Placement;
using test::SolidOptions;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

/// One solid of every kind, placed alike.
Scene all_kinds(const Placement& placement) {
  Scene scene;
  SolidOptions options;
  options.placement = placement;
  test::add_box(scene, Vec3::Zero(), {1, 2, 3}, options);
  test::add_cylinder(scene, 1.0, 2.0, options);
  test::add_frustum(scene, 2.0, 1.0, 2.0, options);
  test::add_cone(scene, 1.0, 2.0, options);
  test::add_sphere(scene, 1.0, options);
  test::add_torus(scene, 3.0, 1.0, options);
  test::add_dome(scene, 1.0, 2.0, 3.0, 0.5, options);
  test::add_box_with_hole(scene, Vec3::Zero(), {1, 2, 3}, 0.2, options);
  test::add_box_with_void(scene, Vec3::Zero(), {1, 2, 3}, 0.2, options);
  return scene;
}

std::vector<HalfEdgeId> twins(const Scene& scene) {
  std::vector<HalfEdgeId> twins;
  for (const HalfEdge& half_edge : scene.half_edges) twins.push_back(half_edge.twin);
  return twins;
}

void forget(Scene& scene) {
  for (HalfEdge& half_edge : scene.half_edges) half_edge.twin = HalfEdgeId{};
  for (Shell& shell : scene.shells) shell.closed = shell.is_void = false;
}

void turn_face(Scene& scene, FaceId id) {
  Face& face = scene.faces[id];
  face.same_sense = !face.same_sense;
  for (const LoopId loop : face.loops) {
    std::vector<HalfEdge> uses;
    for (const HalfEdgeId h : scene.loops[loop].half_edges) uses.push_back(scene.half_edges[h]);
    for (const HalfEdgeId h : scene.loops[loop].half_edges) {
      scene.half_edges[h] = uses.back();
      scene.half_edges[h].forward = !scene.half_edges[h].forward;
      uses.pop_back();
    }
  }
}

void turn_shell(Scene& scene, ShellId id) {
  for (const FaceId face : scene.shells[id].faces) turn_face(scene, face);
}

std::string words(const Scene& scene) {
  std::string text;
  for (const Finding& f : scene.findings) text += f.solid + "|" + f.face + "|" + f.entity + "|" + f.what + "\n";
  return text;
}

class PlacedTopology : public testing::TestWithParam<Placement> {};

TEST_P(PlacedTopology, FindsTwinsClosedShellsAndVoidsWithoutComplaint) {
  const Scene built = all_kinds(GetParam());
  Scene scene = built;
  forget(scene);
  complete_topology(scene);
  EXPECT_EQ(words(scene), "");
  EXPECT_EQ(twins(scene), twins(built));
  for (const ShellId id : scene.shells.ids()) {
    EXPECT_TRUE(scene.shells[id].closed);
    EXPECT_EQ(scene.shells[id].is_void, built.shells[id].is_void);
  }
  for (const Solid& solid : scene.solids) {
    EXPECT_EQ(solid.info.status, SolidStatus::ok);
    EXPECT_TRUE(solid.info.closed);
    EXPECT_THAT(solid.info.healed, IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(Placements, PlacedTopology,
                         testing::Values(Placement{}, Placement::turned({1, 2, 3}, 0.7, {2e4, -1e4, 5}),
                                         Placement::mirrored({1, 2, 3}, {5, 6, 7})));

void swap_faces(Scene& scene, FaceId a, FaceId b) {
  std::swap(scene.faces[a], scene.faces[b]);
  for (const FaceId face : {a, b}) {
    for (const LoopId loop : scene.faces[face].loops) scene.loops[loop].face = face;
  }
}

/// Takes face `gone` out of its solid's only shell by moving it behind the last one that counts.
Scene without_face(Scene scene, FaceId gone) {
  Shell& shell = scene.shells[scene.faces[gone].shell];
  const FaceId last{shell.faces.first.value() + shell.faces.count - 1};
  if (gone != last) swap_faces(scene, gone, last);
  --shell.faces.count;
  return scene;
}

TEST(Topology, EveryDeletedFaceLeavesAnOpenSolidOrAnEmptyOneThatIsNamed) {
  const Scene built = all_kinds({});
  for (const FaceId face : built.faces.ids()) {
    const SolidId solid = built.solid_of(face);
    if (built.solids[solid].shells.count > 1) continue;  // voids have a test of their own
    Scene scene = without_face(built, face);
    complete_topology(scene);
    const bool only = built.shells[built.faces[face].shell].faces.count == 1;
    EXPECT_EQ(scene.solids[solid].info.status, only ? SolidStatus::empty : SolidStatus::open) << face.value();
    EXPECT_FALSE(scene.solids[solid].info.closed);
    EXPECT_THAT(words(scene), HasSubstr(only ? "no face" : "only one face uses this edge"));
  }
}

TEST(Topology, EveryTurnedFaceIsNamedOrTurnedBackWhereItIsTheWholeShell) {
  const Scene built = all_kinds({});
  for (const FaceId face : built.faces.ids()) {
    Scene scene = built;
    turn_face(scene, face);
    complete_topology(scene);
    const Solid& solid = scene.solids[built.solid_of(face)];
    if (built.shells[built.faces[face].shell].faces.count == 1) {
      EXPECT_EQ(scene.faces[face].same_sense, built.faces[face].same_sense);
      EXPECT_THAT(solid.info.healed, SizeIs(1));
    } else {
      EXPECT_EQ(solid.info.status, SolidStatus::invalid) << face.value();
      EXPECT_THAT(words(scene), HasSubstr("in the same sense"));
    }
  }
}

TEST(Topology, ShellsInsideOutAreTurnedAndSaidSo) {
  const Scene built = all_kinds(Placement::mirrored({0, 1, 0}));
  for (const ShellId shell : built.shells.ids()) {
    Scene scene = built;
    turn_shell(scene, shell);
    complete_topology(scene);
    const SolidId solid = built.shells[shell].solid;
    EXPECT_THAT(scene.solids[solid].info.healed, SizeIs(1));
    EXPECT_EQ(scene.solids[solid].info.status, SolidStatus::ok);
    EXPECT_THAT(words(scene), HasSubstr("inside out"));
    EXPECT_NEAR(measure_solid(scene, solid).volume, measure_solid(built, solid).volume, 1e-10);
    EXPECT_EQ(twins(scene), twins(built));
  }
}

TEST(Topology, AnOuterShellListedAfterItsVoidIsPutFirst) {
  Scene scene;
  const auto known = test::add_box_with_void(scene, Vec3::Zero(), {1, 2, 3}, 0.2);
  const ShellId first = scene.solids[known.id].shells.first;
  const ShellId second{first.value() + 1};
  std::swap(scene.shells[first], scene.shells[second]);
  for (const ShellId shell : {first, second}) {
    for (const FaceId face : scene.shells[shell].faces) scene.faces[face].shell = shell;
  }
  complete_topology(scene);
  EXPECT_EQ(words(scene), "");
  EXPECT_FALSE(scene.shells[first].is_void);
  EXPECT_TRUE(scene.shells[second].is_void);
  EXPECT_EQ(scene.shells[first].faces.count, 6u);
  EXPECT_NEAR(measure_solid(scene, known.id).volume, known.volume, 1e-12);
}

TEST(Topology, AVoidOutsideItsSolidIsInvalid) {
  // The sphere's centre is far beyond the box, so only its shell moves out.
  Scene scene;
  const auto known = test::add_box_with_void(scene, Vec3::Zero(), Vec3::Ones(), 0.2);
  const ShellId cavity{scene.solids[known.id].shells.first.value() + 1};
  const Vec3 away{10, 0, 0};
  for (const FaceId face : scene.shells[cavity].faces) {
    std::get<Sphere>(scene.faces[face].surface).frame.origin += away;
    for (const HalfEdgeId h : scene.loops[scene.faces[face].loops.first].half_edges) {
      Edge& edge = scene.edges[scene.half_edges[h].edge];
      if (auto* circle = std::get_if<Ellipse<3>>(&edge.curve); circle != nullptr && circle->center.x() < 5) {
        circle->center += away;
      }
      for (const VertexId v : {edge.start, edge.end}) {
        if (scene.vertices[v].point.x() < 5) scene.vertices[v].point += away;
      }
    }
  }
  complete_topology(scene);
  EXPECT_EQ(scene.solids[known.id].info.status, SolidStatus::invalid);
  EXPECT_THAT(words(scene), HasSubstr("a void lies outside its solid"));
}

/// Two cubes with the common edge x = 1, y = 1 as one shell.
Scene cubes_on_one_edge() {
  test::SolidPlan plan;
  for (int k = 0; k < 8; ++k) plan.vertex({k & 1 ? 1. : 0., k & 2 ? 1. : 0., k & 4 ? 1. : 0.});
  std::vector<std::size_t> second;
  for (int k = 0; k < 8; ++k) {
    const Vec3 p{k & 1 ? 2. : 1., k & 2 ? 2. : 1., k & 4 ? 1. : 0.};
    second.push_back((k & 3) == 0 ? (k & 4 ? 7 : 3) : plan.vertex(p));
  }
  constexpr std::size_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<test::FacePlan> faces;
  for (int cube = 0; cube < 2; ++cube) {
    for (const auto& corners : kFaces) {
      std::vector<std::pair<std::size_t, bool>> loop;
      Vec3 p[3];
      for (int i = 0; i < 4; ++i) {
        const auto at = [&](int c) { return cube == 0 ? corners[c % 4] : second[corners[c % 4]]; };
        loop.push_back(plan.line(at(i), at(i + 1)));
        if (i < 3) p[i] = plan.vertices[at(i)];
      }
      const Vec3 x = (p[1] - p[0]).normalized();
      const Vec3 z = x.cross(p[2] - p[0]).normalized();
      faces.push_back(test::planar_face(plan, {p[0], x, z.cross(x), z}, {loop}));
    }
  }
  // Entered as two shells, for the builder pairs each edge once per shell, and made one afterwards.
  plan.shells.emplace_back(faces.begin(), faces.begin() + 6);
  plan.shells.emplace_back(faces.begin() + 6, faces.end());
  Scene scene;
  const SolidId id = test::enter(scene, plan, {});
  scene.shells[scene.solids[id].shells.first].faces.count = 12;
  scene.solids[id].shells.count = 1;
  for (Face& face : scene.faces) face.shell = scene.solids[id].shells.first;
  // The second face of the first cube at the edge comes last: the order of the faces alone would pair across the cubes.
  swap_faces(scene, FaceId{3}, FaceId{11});
  return scene;
}

TEST(Topology, AnEdgeWhereTwoBodiesTouchIsPairedThroughTheMaterial) {
  const Scene built = cubes_on_one_edge();
  Scene scene = built;
  forget(scene);
  complete_topology(scene);
  EXPECT_EQ(words(scene), "");
  EXPECT_TRUE(scene.shells[ShellId{0}].closed);
  EXPECT_EQ(twins(scene), twins(built));  // each cube with itself
  EXPECT_NEAR(measure_solid(scene, SolidId{0}).volume, 2.0, 1e-12);
}

TEST(Topology, NamesVerticesAndTrimmingCurvesOffTheirEdges) {
  Scene scene = test::scene_of(test::add_cylinder, 1.0, 2.0);
  scene.edges[EdgeId{0}].step_entity = 77;
  scene.vertices[scene.edges[EdgeId{0}].start].point.x() += 1e-3;
  std::get<Ellipse<3>>(scene.edges[EdgeId{1}].curve).center.z() += 2e-3;
  complete_topology(scene);
  EXPECT_THAT(words(scene), HasSubstr("|#77|a vertex lies 0.001 mm off"));
  EXPECT_THAT(words(scene), HasSubstr("the trimming curve lies 0.002 mm off"));
  EXPECT_EQ(scene.solids[SolidId{0}].info.status, SolidStatus::ok);
}

TEST(Topology, NamesLoopsThatDoNotClose) {
  Scene scene = test::scene_of(test::add_box, Vec3(0, 0, 0), Vec3(1, 1, 1));
  // The first edge of the first face ends at a vertex of its own, out of reach.
  scene.edges[scene.half_edges[HalfEdgeId{0}].edge].end = scene.vertices.push_back({{9, 9, 9}, 1e-7});
  complete_topology(scene);
  EXPECT_EQ(scene.solids[SolidId{0}].info.status, SolidStatus::invalid);
  EXPECT_THAT(words(scene), HasSubstr("the loop doesn't close"));
}

TEST(Topology, NumbersThatAreNotFiniteAreNamedAndNothingHangs) {
  Scene scene = test::scene_of(test::add_sphere, 1.0);
  std::get<Sphere>(scene.faces[FaceId{0}].surface).radius = std::numeric_limits<double>::quiet_NaN();
  complete_topology(scene);
  EXPECT_EQ(scene.solids[SolidId{0}].info.status, SolidStatus::invalid);
  EXPECT_THAT(words(scene), HasSubstr("not finite"));
}

TEST(Topology, ManyFaultsOfAKindAreCountedNotListed) {
  Scene scene = test::scene_of(test::add_dome, 1.0, 1.0, 1.0, 0.1);
  for (Vertex& vertex : scene.vertices) vertex.point.x() += 0.1;
  complete_topology(scene);
  const auto named = std::count_if(scene.findings.begin(), scene.findings.end(),
                                   [](const Finding& f) { return f.what.starts_with("a vertex lies"); });
  EXPECT_EQ(named, 5);
  EXPECT_THAT(words(scene), HasSubstr("more vertices off their edges"));
}

TEST(Topology, ASolidWithoutFacesIsEmpty) {
  Scene scene;
  scene.solids.push_back({});
  complete_topology(scene);
  EXPECT_EQ(scene.solids[SolidId{0}].info.status, SolidStatus::empty);
  EXPECT_FALSE(scene.solids[SolidId{0}].info.closed);
}

TEST(Topology, AWorseStatusFromTheReaderStays) {
  Scene scene = test::scene_of(test::add_sphere, 1.0);
  scene.solids[SolidId{0}].info.status = SolidStatus::open;
  scene.solids[SolidId{0}].info.closed = false;
  complete_topology(scene);
  EXPECT_EQ(scene.solids[SolidId{0}].info.status, SolidStatus::open);
  EXPECT_FALSE(scene.solids[SolidId{0}].info.closed);
}

}  // namespace
}  // namespace lamella
