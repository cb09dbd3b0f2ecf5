#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <set>

#include "core/tolerances.h"
#include "model/evaluate.h"
#include "model/step/read_step.h"
#include "model/step/text.h"
#include "tests/support/corpus.h"

namespace lamella {
namespace {

using test::CorpusFile;
using ::testing::Contains;
using ::testing::HasSubstr;

Scene read(const std::string& name) { return read_step(std::vector<std::filesystem::path>{test::corpus_dir() / name}); }

/// The manifest counts the faces and types of every part once, however often it is placed.
std::map<std::string, int> distinct_surface_types(const Scene& scene) {
  std::map<std::string, int> types;
  std::set<int> seen;
  for (const SolidId solid : scene.solids.ids()) {
    const ShellId outer = scene.solids[solid].shells.first;
    const int entity = scene.faces[scene.shells[outer].faces.first].step_entity;
    EXPECT_NE(entity, 0);
    if (!seen.insert(entity).second) continue;
    for (const ShellId shell : scene.solids[solid].shells) {
      for (const FaceId face : scene.shells[shell].faces) {
        ++types[surface_type_name(scene.faces[face].surface)];
        ++types["all"];
      }
    }
  }
  return types;
}

int count_of(const CorpusFile& file, const std::string& column) { return std::stoi(file.text(column)); }

void expect_counts(const Scene& scene, const CorpusFile& file) {
  auto types = distinct_surface_types(scene);
  // Shells and faces outside solids are in the manifest's counts and not in the scene.
  const int loose = count_of(file, "open_shells") > 0 ? count_of(file, "open_shells") : 0;
  EXPECT_EQ(static_cast<int>(scene.solids.size()), count_of(file, "solids"));
  EXPECT_LE(types["all"], count_of(file, "faces"));
  EXPECT_GE(types["all"], count_of(file, "faces") - loose);
  const std::map<std::string, std::string> columns = {
      {"cylinder", "cyl"},    {"cone", "cone"},        {"sphere", "sphere"},    {"torus", "torus"},
      {"bspline", "bspline"}, {"revolution", "revol"}, {"extrusion", "extrus"}, {"fitted", "offset"}};
  for (const auto& [type, column] : columns) {
    int expected = count_of(file, column);
    if (type == "bspline") expected += count_of(file, "bezier");
    EXPECT_EQ(types[type], expected) << type;
  }
}

/// Half-edges run head to tail, edges lie on their faces within their tolerance, nothing is infinite.
void expect_sound_geometry(const Scene& scene) {
  double worst = 0.0;
  for (const HalfEdge& h : scene.half_edges) {
    const Edge& edge = scene.edges[h.edge];
    if (edge.degenerate) continue;
    const Surface& surface = scene.faces[scene.loops[h.loop].face].surface;
    for (const double s : {0.0, 0.3, 0.77, 1.0}) {
      const Vec3 in_space = evaluate<3>(edge.curve, edge.range.lo + s * edge.range.length()).point;
      const Vec2 uv = evaluate<2>(h.pcurve, h.prange.lo + s * h.prange.length()).point;
      // The reader samples too; between its samples and these lies little.
      worst = std::max(worst, (evaluate_point(surface, uv) - in_space).norm() - 1.05 * edge.tolerance);
    }
  }
  EXPECT_LE(worst, 1e-9 * (1.0 + scene.vertices[VertexId{0}].point.norm()));
  for (const Vertex& vertex : scene.vertices) EXPECT_TRUE(vertex.point.allFinite());
}

void expect_sound_names(const Scene& scene) {
  std::set<std::string> paths;
  for (const Solid& solid : scene.solids) {
    EXPECT_TRUE(paths.insert(solid.info.path).second) << "twice: " << solid.info.path;
    EXPECT_TRUE(solid.info.path.starts_with('/'));
    EXPECT_FALSE(solid.info.name.empty()) << solid.info.path;
    EXPECT_TRUE(step::is_utf8(solid.info.name) && step::is_utf8(solid.info.path));
  }
}

/// A test a file, so that they run side by side.
class SoundFile : public ::testing::TestWithParam<CorpusFile> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SoundFile);
INSTANTIATE_TEST_SUITE_P(ReadStepCorpus, SoundFile, ::testing::ValuesIn(test::corpus_files("ok")),
                         [](const auto& tested) { return test::test_name(tested.param); });

TEST_P(SoundFile, ReadsAsTheManifestSays) {
  const CorpusFile& file = GetParam();
  const Scene scene = read(file.name);
  expect_counts(scene, file);
  expect_sound_geometry(scene);
  expect_sound_names(scene);
  EXPECT_EQ(scene.files.at(0).schema, file.text("schema_AP"));
  EXPECT_EQ(scene.files.at(0).unit, file.text("length_unit"));
  for (const Solid& solid : scene.solids) {
    EXPECT_EQ(solid.info.status, SolidStatus::ok) << solid.info.path;
    EXPECT_TRUE(solid.info.closed) << solid.info.path;
  }
  for (const Finding& finding : scene.findings) EXPECT_NE(finding.severity, Severity::error) << finding.what;
}

TEST(ReadStepCorpus, HasAllSoundFiles) {
  LAMELLA_NEEDS_CORPUS();
  EXPECT_EQ(test::corpus_files("ok").size(), 53U);
}

TEST(ReadStepCorpus, ReadsNamesMaterialsAndColors) {
  LAMELLA_NEEDS_CORPUS();
  const Scene bracket = read("asm_ocij_dm1_oc_214.stp");
  const SolidInfo& nut = bracket.solids[SolidId{0}].info;
  EXPECT_EQ(nut.path, "/l-bracket assembly/nut-bolt-assembly.1/nut");
  EXPECT_EQ(nut.step_material, "AMS 5662; Inconel 718");
  EXPECT_NEAR(nut.step_density.value_or(0), 8.210195, 1e-9);
  std::set<std::string> materials;
  for (const Solid& solid : read("asm_pocc_eight_cyl.stp").solids) materials.insert(solid.info.step_material);
  EXPECT_EQ(materials.size(), 8U);
  std::set<std::string> paths;
  for (const Solid& solid : read("elec_voron_fan_pcb_v1_0.step").solids) paths.insert(solid.info.path);
  EXPECT_THAT(paths, Contains("/Fan PCB v4/Packages/B2B-XH-A.1/K\xC3\xB6rper1"));
  const Scene spheres = read("asm_occt_bug24283_spheres.stp");
  EXPECT_EQ(spheres.solids[SolidId{1}].info.color, (Color{1.0, 1.0, 0.0}));
}

/// A bad file of which nothing is left: the error's text holds these words.
struct Refusal {
  const char* file;
  std::vector<const char*> words;
};

TEST(ReadStepCorpus, RefusesFilesWithoutSolidsAndSaysWhy) {
  LAMELLA_NEEDS_CORPUS();
  const std::vector<Refusal> refusals = {
      {"badr_aeth_gen_box_v0.step", {"without product structure and units", "#1", "line 5"}},
      {"badr_aeth_malformed_missing_paren.step", {"syntax error in #1", "bracket", "line 1"}},
      {"badr_occt_bug33410.step", {"tessellated", "#92"}},
      {"badr_occt_bug33638.stp", {"tessellated", "#32"}},
      {"badr_occt_trj10_ch1_tu_203.stp", {"construction history", "#169"}},
      {"badr_ocij_s1_c5_214.stp", {"never opened", "TAIL.stp", "#33"}},
      {"badr_stepcode_missing_and_required.p21", {"#56", "CARTESIAN_POINT", "name"}}};
  for (const Refusal& refusal : refusals) {
    try {
      (void)read(refusal.file);
      ADD_FAILURE() << refusal.file << " was read";
    } catch (const InputError& error) {
      const std::string said = std::string(error.what()) + " (" + error.where() + ")";
      for (const char* word : refusal.words) EXPECT_THAT(said, HasSubstr(word)) << refusal.file;
      EXPECT_FALSE(error.hint().empty() && std::string(refusal.file).find("malformed") == std::string::npos);
    }
  }
}

bool any_finding(const Scene& scene, const std::string& entity, const std::string& word) {
  for (const Finding& finding : scene.findings) {
    if (finding.entity == entity && finding.what.find(word) != std::string::npos) return true;
  }
  return false;
}

int usable(const Scene& scene) {
  int count = 0;
  for (const Solid& solid : scene.solids) count += solid.info.status == SolidStatus::ok && solid.info.closed ? 1 : 0;
  return count;
}

TEST(ReadStepCorpus, NamesTheFaultsOfDoubtfulFiles) {
  LAMELLA_NEEDS_CORPUS();
  struct Doubt {
    const char* file;
    int usable_solids;
    const char* entity;
    const char* word;
  };
  const std::vector<Doubt> doubts = {
      {"badw_afem_777_200lr.stp", 0, "#55", "one face"},
      {"badw_horizon_68w.step", 0, "#215", "bounds no solid"},
      {"badw_nist_nist_stc_07_ap242_e3.stp", 1, "#117", "outside any solid"},
      {"badw_occt_bug25169_box_openshell.stp", 1, "#16", "OPEN_SHELL"},
      {"badw_occt_bug25415_hdrv8w64p254_4x2_10.stp", 0, "#54", "invalid"},
      {"badw_occt_bug28366_fuselage.stp", 0, "#55", "one face"},
      {"badw_occt_bug28414_bug_toroidal_surfac.stp", 0, "#3297", "used by one face only"},
      {"badw_occt_bug32314_corrupted.stp", 11, "#393076", "isn't in the file"},
      {"badw_occt_occ22459_test2.stp", 0, "#110", "rim of the open shell"}};
  for (const Doubt& doubt : doubts) {
    SCOPED_TRACE(doubt.file);
    const Scene scene = read(doubt.file);
    EXPECT_EQ(usable(scene), doubt.usable_solids);
    EXPECT_TRUE(any_finding(scene, doubt.entity, doubt.word));
    EXPECT_TRUE(static_cast<int>(scene.solids.size()) >= doubt.usable_solids);
  }
}

}  // namespace
}  // namespace lamella
