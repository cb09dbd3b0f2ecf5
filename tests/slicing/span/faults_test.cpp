/// Every face of every solid deleted in turn, turned in turn, and turned without its loops: the check of the topology
/// must name it. Where only the engine looks, rows must not close.

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <string>

#include "model/topology.h"
#include "tests/support/cut_scene.h"
#include "tests/support/single_solid.h"
#include "tests/support/step_scenes.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

namespace lamella {
namespace {

enum class Fault { deleted, turned, turned_without_loops };

std::string text_of(Fault fault) {
  return fault == Fault::deleted ? "deleted" : fault == Fault::turned ? "turned" : "turned without its loops";
}

void apply(Scene& scene, FaceId face, Fault fault) {
  if (fault == Fault::deleted) test::delete_face(scene, face);
  if (fault == Fault::turned) test::turn_face(scene, face);
  if (fault == Fault::turned_without_loops) scene.faces[face].same_sense = !scene.faces[face].same_sense;
}

/// As the reader leaves a solid that nobody has checked.
void forget_checks(Scene& scene) {
  scene.findings.clear();
  for (Solid& solid : scene.solids) {
    solid.info.status = SolidStatus::ok;
    solid.info.closed = true;
    solid.info.healed.clear();
  }
}

/// Whether a solid's own records or the scene's findings tell of a fault.
bool is_named(const Scene& scene) {
  const SolidInfo& info = scene.solids[SolidId{0}].info;
  return info.status != SolidStatus::ok || !info.closed || !info.healed.empty() || !scene.findings.empty();
}

/// One solid for each shape: instances of a part fail alike.
std::vector<SolidId> different_solids(const Scene& scene) {
  std::map<std::string, SolidId> firsts;
  for (const SolidId id : test::sound_solids(scene)) {
    const Vec3 size = test::solid_box(scene, id).sizes();
    std::size_t faces = 0;
    for (const ShellId shell : scene.solids[id].shells) faces += scene.shells[shell].faces.count;
    const auto rounded = [](double x) { return std::to_string(std::lround(1e3 * x)); };
    firsts.try_emplace(std::to_string(faces) + " " + rounded(size.x() + size.y()) + " " + rounded(size.z()), id);
  }
  std::vector<SolidId> solids;
  for (const auto& [key, id] : firsts) solids.push_back(id);
  return solids;
}

/// Faces of one solid's scene, evenly chosen when there are more than `most`.
std::vector<FaceId> some_faces(const Scene& scene, std::size_t most) {
  std::vector<FaceId> faces;
  const std::size_t count = scene.faces.size();
  for (std::size_t i = 0; i < std::min(count, most); ++i) faces.emplace_back(i * count / std::min(count, most));
  return faces;
}

void expect_named(const Scene& scene, std::size_t most) {
  std::size_t tried = 0;
  for (const SolidId id : different_solids(scene)) {
    Scene sound = test::single_solid(scene, id);
    forget_checks(sound);
    complete_topology(sound);
    ASSERT_EQ(sound.solids[SolidId{0}].info.status, SolidStatus::ok) << "solid " << id.value();
    const std::size_t remarks = sound.findings.size() + sound.solids[SolidId{0}].info.healed.size();
    if (remarks > 0) continue;  // a file that needs healing says so already
    for (const FaceId face : some_faces(sound, most)) {
      for (const Fault fault : {Fault::deleted, Fault::turned, Fault::turned_without_loops}) {
        Scene faulty = sound;
        apply(faulty, face, fault);
        forget_checks(faulty);
        complete_topology(faulty);
        ++tried;
        EXPECT_TRUE(is_named(faulty)) << "solid " << id.value() << " face " << face.value() << " "
                                      << surface_type_name(sound.faces[face].surface) << " " << text_of(fault);
      }
    }
  }
  EXPECT_GT(tried, 0U);
}

/// Whether layers between the heights of its vertices meet edges that the face shares with others.
bool shows_in_sections(const Scene& scene, FaceId face) {
  for (const LoopId loop : scene.faces[face].loops) {
    for (const HalfEdgeId id : scene.loops[loop].half_edges) {
      const HalfEdge& use = scene.half_edges[id];
      const Edge& edge = scene.edges[use.edge];
      if (edge.degenerate || !use.twin.valid()) continue;
      const bool is_seam = scene.loops[scene.half_edges[use.twin].loop].face == face;
      if (!is_seam && scene.vertices[edge.start].point.z() != scene.vertices[edge.end].point.z()) return true;
    }
  }
  return false;
}

class FaultsInFiles : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(FaultsInFiles, AreNamedBeforeAnythingIsCut) { expect_named(test::read_scene(GetParam()), 64); }

const auto kName = [](const auto& given) { return test::test_name(given.param); };
INSTANTIATE_TEST_SUITE_P(Datasets, FaultsInFiles, testing::ValuesIn(test::dataset_files()), kName);
INSTANTIATE_TEST_SUITE_P(Bench, FaultsInFiles, testing::ValuesIn(test::bench_files()), kName);

struct Made {
  std::string name;
  Scene scene;
};

std::vector<Made> make_solids() {
  std::vector<Made> made;
  const auto add = [&](const std::string& name, const auto& build) {
    made.push_back({name, {}});
    build(made.back().scene);
  };
  add("Box", [](Scene& s) { test::add_box(s, {-1, -1, -1}, {1, 1.5, 1}); });
  add("Sphere", [](Scene& s) { test::add_sphere(s, 1.0); });
  add("Cylinder", [](Scene& s) { test::add_cylinder(s, 1.0, 1.25); });
  add("Cone", [](Scene& s) { test::add_cone(s, 1.0, 1.25); });
  add("Torus", [](Scene& s) { test::add_torus(s, 1.0, 0.5); });
  add("Dome", [](Scene& s) { test::add_dome(s, 2.0, 1.5, 1.0, 0.5); });
  add("BoxWithHole", [](Scene& s) { test::add_box_with_hole(s, {-1, -1, 0}, {1, 1, 2}, 0.5); });
  add("BoxWithVoid", [](Scene& s) { test::add_box_with_void(s, {-1, -1, 0}, {1, 1, 2}, 0.5); });
  add("Ring", [](Scene& s) { test::add_revolved_ring(s, 1.25, 0.25, 0.5); });
  add("Ellipsoid", [](Scene& s) { test::add_revolved_ellipsoid(s, 1.25, 0.5); });
  return made;
}

const std::vector<Made>& solids_made() {
  static const std::vector<Made> made = make_solids();
  return made;
}

class FaultsInSolids : public testing::TestWithParam<std::size_t> {};

TEST_P(FaultsInSolids, AreNamedBeforeAnythingIsCut) { expect_named(solids_made()[GetParam()].scene, 100); }

/// The engine may be handed a scene that nobody has checked. It can't see a face go whose edges are all seams or
/// horizontal: those leave no end of an arc alone.
TEST_P(FaultsInSolids, LeaveRowsOpenWhereSectionsMeetTheirEdges) {
  const Scene& sound = solids_made()[GetParam()].scene;
  const Box3 box = test::solid_box(sound, SolidId{0});
  std::vector<LayerRequest> requests;
  for (std::size_t k = 0; k < kSlabLayers; ++k) {
    const double part = (static_cast<double>(k) + 0.43) / static_cast<double>(kSlabLayers);
    requests.push_back({k, box.min().z() + part * box.sizes().z(), {test::lattice_over(box, 0.3, 40, 0.7)}});
  }
  for (const FaceId face : sound.faces.ids()) {
    for (const Fault fault : {Fault::deleted, Fault::turned}) {
      Scene faulty = sound;
      apply(faulty, face, fault);
      const SpanEngine engine(faulty, test::all_solids(faulty), {1e-7, 1});
      const CastCounters counters = test::total(test::cut_layers(engine, requests));
      const bool shows = counters.unclosed_rays > 0 || !engine.findings().empty();
      EXPECT_TRUE(shows || !shows_in_sections(sound, face))
          << "face " << face.value() << " " << surface_type_name(sound.faces[face].surface) << " " << text_of(fault);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Solids, FaultsInSolids, testing::Range<std::size_t>(0, solids_made().size()),
                         [](const auto& given) { return solids_made()[given.param].name; });

}  // namespace
}  // namespace lamella
