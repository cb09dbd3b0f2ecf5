#include "slicing/accuracy/stl_file.h"

#include <fstream>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/paths.h"

namespace lamella::accuracy {
namespace {

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0.1, 0, 0}, {1.1, 0, 0}, {0.1, 1, 0}, {0.1, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

TEST(StlFile, HoldsCoordinatesInSinglePrecision) {
  const test::TemporaryFolder folder;
  write_stl(tetrahedron(), folder / "a.stl");
  EXPECT_EQ(std::filesystem::file_size(folder / "a.stl"), 84U + 4U * 50U);
  const std::vector<StlTriangle> triangles = read_stl(folder / "a.stl");
  ASSERT_EQ(triangles.size(), 4U);
  EXPECT_EQ(triangles[0], (StlTriangle{0.1f, 0, 0, 0.1f, 1, 0, 1.1f, 0, 0}));
  EXPECT_NE(static_cast<double>(triangles[0][0]), 0.1);
  EXPECT_NEAR(enclosed_volume(triangles), 1.0 / 6.0, 1e-7);
  EXPECT_NE(enclosed_volume(triangles), 1.0 / 6.0);
}

TEST(StlFile, ManyTrianglesComeBack) {
  const test::TemporaryFolder folder;
  TriangleMesh mesh = tetrahedron();
  while (mesh.triangles.size() < 20000) mesh.triangles.push_back(mesh.triangles[mesh.triangles.size() % 4]);
  write_stl(mesh, folder / "a.stl");
  const std::vector<StlTriangle> triangles = read_stl(folder / "a.stl");
  ASSERT_EQ(triangles.size(), 20000U);
  for (std::size_t i = 0; i < triangles.size(); ++i) EXPECT_EQ(triangles[i], triangles[i % 4]);
}

TEST(StlFile, DamagedFilesAreRefused) {
  const test::TemporaryFolder folder;
  EXPECT_THROW((void)read_stl(folder / "absent.stl"), InputError);
  std::ofstream(folder / "short.stl") << "solid";
  EXPECT_THROW((void)read_stl(folder / "short.stl"), InputError);
  write_stl(tetrahedron(), folder / "a.stl");
  std::filesystem::resize_file(folder / "a.stl", 84 + 3 * 50 + 7);
  EXPECT_THROW((void)read_stl(folder / "a.stl"), InputError);
}

TEST(StlFile, AFullOrMissingFolderIsAnExportError) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_stl(tetrahedron(), folder / "absent" / "a.stl"), ExportError);
  if (std::filesystem::exists("/dev/full")) {
    EXPECT_THROW(write_stl(tetrahedron(), "/dev/full"), ExportError);
  }
}

}  // namespace
}  // namespace lamella::accuracy
