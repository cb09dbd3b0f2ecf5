// What a user of OpenVDB does to get fog volumes from a STEP file: tessellate with OpenCASCADE, turn each solid's
// triangles into a signed distance and that into fog, and write the grids. bench/outputs_run.py times it as a whole.

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>
#include <string>

#include "bench/tessellation.h"

namespace {

/// What meshToVolume is asked for on both sides, voxels; the inner side is all of the solid.
constexpr float kBand = 3.0F;

openvdb::GridBase::Ptr fog_of(const lamella::bench::SolidMesh& solid, const openvdb::math::Transform& transform) {
  std::vector<openvdb::Vec3s> points;
  for (const lamella::Vec3& vertex : solid.vertices) {
    points.emplace_back(transform.worldToIndex(openvdb::Vec3d(vertex.x(), vertex.y(), vertex.z())));
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& corner : solid.triangles) triangles.emplace_back(corner[0], corner[1], corner[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, transform, kBand, kBand);
  openvdb::tools::sdfToFogVolume(*grid, 1.0F);
  return grid;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 5) {
    std::fprintf(stderr, "usage: fog_openvdb MODEL.step DEFLECTION_MM VOXEL_MM OUT.vdb\n");
    return EXIT_FAILURE;
  }
  openvdb::initialize();
  const auto model = lamella::bench::tessellate(arguments[1], std::stod(arguments[2]));
  const auto transform = openvdb::math::Transform::createLinearTransform(std::stod(arguments[3]));
  openvdb::GridPtrVec grids;
  openvdb::Index64 voxels = 0;
  for (const auto& solid : model.solids) {
    grids.push_back(fog_of(solid, *transform));
    voxels += grids.back()->activeVoxelCount();
  }
  openvdb::io::File(arguments[4]).write(grids);
  std::printf("{\"triangles\": %zu, \"active_voxels\": %llu, \"tessellation\": %.3f}\n", model.triangle_count(),
              static_cast<unsigned long long>(voxels), model.seconds);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::fprintf(stderr, "fog_openvdb: %s\n", error.what());
  return EXIT_FAILURE;
}
