/// The STL side of the study against OpenCASCADE's own tools, which read, tessellate and write here by themselves; and
/// against closed forms on bodies that OpenCASCADE makes.

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepTools.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <StlAPI_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <random>

#include "model/nearest_point.h"
#include "model/step/read_step.h"
#include "slicing/accuracy/accuracy_study.h"
#include "slicing/accuracy/stl_file.h"
#include "tests/support/paths.h"

namespace lamella::accuracy {
namespace {

constexpr double kAngle = 0.5;

std::vector<TopoDS_Solid> occt_solids(const std::filesystem::path& file) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(file.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  std::vector<TopoDS_Solid> solids;
  for (TopExp_Explorer it(reader.OneShape(), TopAbs_SOLID); it.More(); it.Next()) {
    solids.push_back(TopoDS::Solid(it.Current()));
  }
  return solids;
}

/// The corners in a binary STL file, each triangle beginning with its least corner, triangles in ascending order.
std::vector<StlTriangle> corners_in(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(bytes.size(), 84 + 50 * static_cast<std::size_t>(count));
  std::vector<StlTriangle> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<std::array<float, 3>, 3> c{};
    std::memcpy(c.data(), bytes.data() + 84 + 50 * static_cast<std::size_t>(i) + 12, 36);
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    StlTriangle& triangle = triangles.emplace_back();
    std::memcpy(triangle.data(), c.data(), 36);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

struct Model {
  Scene scene;
  StepShapes shapes;
  std::vector<SolidId> solids;
};

Model read_model(const std::filesystem::path& file) {
  Model model;
  const std::vector<StepPart> parts{{file, {}}};
  model.scene = read_step_parts(parts, {}, {}, &model.shapes);
  for (const SolidId solid : model.scene.solids.ids()) model.solids.push_back(solid);
  return model;
}

std::filesystem::path dataset(const std::string& name) { return test::datasets_dir() / name / (name + ".step"); }

Tessellation tessellate(Model& model, double deflection) {
  TessellationOptions options;
  options.deflection = deflection;
  options.angle = kAngle;
  options.in_parallel = false;
  return model.shapes.tessellate(model.solids, options);
}

class SameMeshes : public ::testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(SameMeshes, AsThoseOfOpenCascadesOwnReaderMesherAndWriter) {
  const auto& [name, deflection] = GetParam();
  const test::TemporaryFolder folder;
  Model model = read_model(dataset(name));
  const Tessellation ours = tessellate(model, deflection);
  std::vector<TopoDS_Solid> solids = occt_solids(dataset(name));
  ASSERT_EQ(ours.solids.size(), solids.size());
  std::size_t total = 0;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    BRepMesh_IncrementalMesh(solids[i], deflection, Standard_False, kAngle, Standard_False);
    StlAPI_Writer writer;
    writer.ASCIIMode() = Standard_False;
    ASSERT_TRUE(writer.Write(solids[i], (folder / "theirs.stl").c_str()));
    write_stl(ours.solids[i], folder / "ours.stl");
    const std::vector<StlTriangle> theirs = corners_in(folder / "theirs.stl");
    EXPECT_EQ(ours.solids[i].triangles.size(), theirs.size()) << i;
    EXPECT_EQ(corners_in(folder / "ours.stl"), theirs) << i;
    EXPECT_EQ(read_stl(folder / "ours.stl").size(), theirs.size());
    total += theirs.size();
  }
  EXPECT_EQ(ours.triangles, total);
  EXPECT_EQ(ours.faces_without, 0U);
}

INSTANTIATE_TEST_SUITE_P(DataSets, SameMeshes,
                         ::testing::Values(std::pair{"turbine_blade_16", 0.1}, std::pair{"nested_spheres", 0.05},
                                           std::pair{"impeller_135", 0.02}, std::pair{"bone_screw", 0.05},
                                           std::pair{"lattice_in_shell", 0.3}));

/// Largest distance of a solid's triangles' middles from its surface, some at random, by OpenCASCADE and by ours.
std::pair<double, double> largest_distances(const Model& model, const TriangleMesh& mesh, std::size_t solid,
                                            const TopoDS_Shape& shape, int count) {
  const NearestPoint nearest(model.scene, faces_of(model.scene, model.solids[solid]));
  TopoDS_Shell shell;
  for (TopExp_Explorer it(shape, TopAbs_SHELL); it.More(); it.Next()) shell = TopoDS::Shell(it.Current());
  std::mt19937 random(11);
  std::uniform_int_distribution<std::size_t> pick(0, mesh.triangles.size() - 1);
  std::pair<double, double> largest{0.0, 0.0};
  for (int i = 0; i < count; ++i) {
    const auto& triangle = mesh.triangles[pick(random)];
    const Vec3 middle = (mesh.vertices[triangle[0]] + mesh.vertices[triangle[1]] + mesh.vertices[triangle[2]]) / 3.0;
    const BRepExtrema_DistShapeShape distance(
        BRepBuilderAPI_MakeVertex(gp_Pnt(middle.x(), middle.y(), middle.z())).Vertex(), shell);
    const double theirs = distance.Value();
    const double own = nearest.find(middle)->distance;
    EXPECT_NEAR(own, theirs, 1e-6) << middle.transpose();
    largest.first = std::max(largest.first, theirs);
    largest.second = std::max(largest.second, own);
  }
  return largest;
}

TEST(MeshDistance, AgreesWithOpenCascadesExtrema) {
  Model model = read_model(dataset("turbine_blade_16"));
  const Tessellation mesh = tessellate(model, 0.1);
  std::vector<TopoDS_Solid> solids = occt_solids(dataset("turbine_blade_16"));
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const auto [theirs, ours] = largest_distances(model, mesh.solids[s], s, solids[s], 150);
    EXPECT_GT(theirs, 1e-3);
    EXPECT_NEAR(ours, theirs, 1e-6);
  }
}

/// The largest distance of a triangle's middle from the surface, by OpenCASCADE's extrema, which must agree with ours
/// at the ten farthest middles of each solid.
double largest_distance(const std::filesystem::path& file, double deflection) {
  Model model = read_model(file);
  const Tessellation mesh = tessellate(model, deflection);
  const std::vector<TopoDS_Solid> solids = occt_solids(file);
  double largest = 0.0;
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const NearestPoint nearest(model.scene, faces_of(model.scene, model.solids[s]));
    TopoDS_Shell shell;
    for (TopExp_Explorer it(solids[s], TopAbs_SHELL); it.More(); it.Next()) shell = TopoDS::Shell(it.Current());
    std::vector<std::pair<double, Vec3>> middles;
    for (const auto& t : mesh.solids[s].triangles) {
      const auto& v = mesh.solids[s].vertices;
      const Vec3 middle = (v[t[0]] + v[t[1]] + v[t[2]]) / 3.0;
      middles.emplace_back(nearest.find(middle)->distance, middle);
    }
    const auto farther = [](const auto& a, const auto& b) { return a.first > b.first; };
    std::partial_sort(middles.begin(), middles.begin() + 10, middles.end(), farther);
    for (std::size_t i = 0; i < 10; ++i) {
      const Vec3& p = middles[i].second;
      const BRepExtrema_DistShapeShape distance(BRepBuilderAPI_MakeVertex(gp_Pnt(p.x(), p.y(), p.z())).Vertex(), shell);
      EXPECT_NEAR(middles[i].first, distance.Value(), 1e-6) << s << ": " << p.transpose();
      largest = std::max(largest, distance.Value());
    }
  }
  ::testing::Test::RecordProperty("largest_distance_in_nm", static_cast<int>(largest * 1e6));
  return largest;
}

// Fine meshes of OpenCASCADE's lie further from the surface than asked for in places (docs/accuracy.md). There too its
// own extrema say the same.
TEST(MeshDistance, AgreesWithOpenCascadesExtremaWhereItIsLargest) {
  EXPECT_GT(largest_distance(dataset("housing_102"), 0.003), 0.5 * 0.003);
}

TEST(MeshDistance, AgreesWithOpenCascadesExtremaOnAThirdPartyFile) {
  LAMELLA_NEEDS_CORPUS();
  EXPECT_GT(largest_distance(test::corpus_dir() / "mech_trimesh_featuretype.step", 0.003), 0.5 * 0.003);
}

// A cylinder's mesh is a prism over a regular polygon, so all of its errors are known from its number of sides.
TEST(Cylinder, MeshErrorsAreThoseOfItsPrism) {
  constexpr double kRadius = 7.0;
  constexpr double kHeight = 3.0;
  const test::TemporaryFolder folder;
  STEPControl_Writer writer;
  writer.Transfer(BRepPrimAPI_MakeCylinder(kRadius, kHeight).Shape(), STEPControl_AsIs);
  ASSERT_EQ(writer.Write((folder / "cylinder.step").c_str()), IFSelect_RetDone);
  Model model = read_model(folder / "cylinder.step");
  const auto measures = measure_solids(model.scene);
  StudyOptions options;
  options.deflections = {0.5, 0.05, 0.005};
  options.rays = 5000;
  options.distance_samples = 20'000;
  const StudyResult result = run_study(model.scene, measures, model.shapes, options);
  EXPECT_NEAR(result.volume, kPi * kRadius * kRadius * kHeight, 1e-6);
  EXPECT_LT(result.direct.errors.largest, 1e-9);
  for (const StlResult& stl : result.stl) {
    // n - 2 triangles on top and bottom, two for each side.
    const double n = (static_cast<double>(stl.triangles) + 4.0) / 4.0;
    const double area = 0.5 * n * kRadius * kRadius * std::sin(2.0 * kPi / n);
    const double lost = kPi * kRadius * kRadius - area;
    const double sagitta = kRadius * (1.0 - std::cos(kPi / n));
    EXPECT_NEAR(stl.volume_error, lost * kHeight, 1e-3 * lost * kHeight + 2e-4) << n;
    EXPECT_NEAR(stl.area.largest, lost, 1e-3 * lost + 1e-4) << n;
    EXPECT_LE(stl.distance.largest, sagitta + 1e-6) << n;
    EXPECT_GT(stl.distance.largest, 0.8 * sagitta) << n;
    EXPECT_LE(sagitta, stl.deflection);
    EXPECT_EQ(stl.errors.false_, 0U);  // the prism lies within the cylinder
  }
}

}  // namespace
}  // namespace lamella::accuracy
