#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <random>
#include <utility>

#include "export/dither_sink.h"
#include "export/grey_png_stack.h"
#include "export/mixed_row.h"
#include "export/png_stack.h"
#include "export/vdb/vdb_sink.h"
#include "export/xml_slices.h"
#include "tests/slicing/store_sample.h"
#include "tests/support/graded_scene.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using test::CollectingSink;
using test::GradedScene;

/// The scene as it was sliced once.
const CollectingSink& sliced() {
  static const CollectingSink kSink = [] {
    CollectingSink sink;
    (void)GradedScene(0.1).slice_into(sink);
    return sink;
  }();
  return kSink;
}

TEST(GradedXml, GivesBackWhatWasWritten) {
  const CollectingSink& from = sliced();
  const std::vector<Layer> some(from.layers.begin() + 20, from.layers.begin() + 24);
  ASSERT_FALSE(some[0].raster.mixtures.empty());
  ASSERT_FALSE(some[0].hatch->rows.mixtures.empty());
  for (const XmlPayload payload : {XmlPayload::text, XmlPayload::binary}) {
    const test::TemporaryFolder folder;
    const auto sink = make_xml_sink(folder / "s.xml", payload);
    test::feed(*sink, from.info, some, from.report);
    CollectingSink back;
    read_xml_slices(folder / "s.xml", back);
    EXPECT_EQ(back.layers, some);
    EXPECT_EQ(back.info.materials[MaterialId{2}].components, from.info.materials[MaterialId{2}].components);
    const std::string command = "xmllint --nonet --noout --schema '" +
                                (test::source_dir() / "schemas/slices.xsd").string() + "' '" +
                                (folder / "s.xml").string() + "' >/dev/null 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0);
    // A number that is missing or one too many is an error.
    const std::string text = test::read_file(folder / "s.xml");
    for (const char* name : {"<mixtures segments=\"", " knots=\"", " fractions=\""}) {
      std::string changed = text;
      const std::size_t at = changed.find(name, changed.find("<mixtures") - 1) + std::string(name).size();
      changed[at] = changed[at] == '1' ? '2' : '1';
      test::write_file(folder / "c.xml", changed);
      CollectingSink ignored;
      EXPECT_THROW(read_xml_slices(folder / "c.xml", ignored), InputError) << name;
    }
  }
}

TEST(GreyPng, PixelsAreTheFractionsAtTheirCentres) {
  const CollectingSink& from = sliced();
  const std::vector<Layer> one(from.layers.begin() + 24, from.layers.begin() + 25);
  const double z = one[0].z_sample - 0.0;
  for (const int bits : {8, 16}) {
    const test::TemporaryFolder folder;
    const auto sink = make_grey_png_sink(folder / "grey", bits);
    test::feed(*sink, from.info, one, from.report);
    EXPECT_FALSE(std::filesystem::exists(folder / "grey/skin"));
    const std::string command =
        "/usr/bin/python3 -c \"import sys\nfrom PIL import Image\nimport numpy as np\n"
        "a=np.asarray(Image.open(sys.argv[1])).astype(float)/float(sys.argv[2])\n"
        "x,y=int(sys.argv[3]),a.shape[0]-1-int(sys.argv[4])\n"
        "sys.exit(0 if abs(a[y,x]-float(sys.argv[5]))<2.2e-3+1.5/float(sys.argv[2]) else 1)\" ";
    const Grid& grid = from.info.plan.grid;
    const auto check = [&](const char* material, double x, double y, double share) {
      const auto i = static_cast<int>((x - grid.origin.x()) / grid.pitch.x());
      const auto j = static_cast<int>((y - grid.origin.y()) / grid.pitch.y());
      const std::string arguments = "'" + (folder / "grey" / material / "layer_000024.png").string() + "' " +
                                    std::to_string((1 << bits) - 1) + " " + std::to_string(i) + " " +
                                    std::to_string(j) + " " + std::to_string(share);
      EXPECT_EQ(std::system((command + arguments).c_str()), 0) << arguments;
    };
    check("B", 2.0, 2.0, z / 8.0);
    check("A", 2.0, 2.0, 1.0 - z / 8.0);
    check("B", 14.0, 16.0, 1.0);
    check("A", 14.0, 16.0, 0.0);
    check("A", 10.0, 10.0, 0.0);
    check("A", 5.5, 16.0, 0.8);
  }
}

/// The mean share of B in a layer's voxels of the box, which is graded along z.
double dithered_share(const Layer& layer, const BuildInfo& info) {
  double b = 0.0;
  double all = 0.0;
  for (std::size_t r = 0; r < layer.raster.rows(); ++r) {
    for (const Segment& segment : layer.raster.row(r)) {
      if (segment.solid != SolidId{0}) continue;
      const PixelRun pixels = pixels_of(segment, info.plan.grid);
      const auto count = static_cast<double>(pixels.end - pixels.begin);
      all += count;
      if (segment.material == MaterialId{1}) b += count;
    }
  }
  return b / all;
}

TEST(Dithered, LayersHaveVoxelsOfPlainMaterialsInTheRightShare) {
  const CollectingSink& from = sliced();
  auto inner = std::make_unique<CollectingSink>();
  CollectingSink& to = *inner;
  const auto sink = make_dither_sink(std::move(inner));
  test::feed(*sink, from.info, from.layers, from.report);
  ASSERT_EQ(to.info.materials.size(), 2U);
  ASSERT_EQ(to.layers.size(), from.layers.size());
  EXPECT_EQ(to.report.materials.size(), 2U);
  std::int64_t compared = 0;
  for (std::size_t k = 0; k < to.layers.size(); ++k) {
    const Layer& layer = to.layers[k];
    EXPECT_TRUE(layer.raster.mixtures.empty());
    const double z = layer.z_sample;
    if (z > 0.0 && z < 8.0) {
      EXPECT_NEAR(dithered_share(layer, to.info), z / 8.0, 0.01) << z;
      ++compared;
    }
    // Where there is material there is still, and nowhere else.
    for (std::size_t r = 0; r < layer.raster.rows(); ++r) {
      const auto pixels = [&](std::span<const Segment> row) {
        std::int64_t count = 0;
        for (const Segment& s : row)
          count += pixels_of(s, to.info.plan.grid).end - pixels_of(s, to.info.plan.grid).begin;
        return count;
      };
      ASSERT_EQ(pixels(layer.raster.row(r)), pixels(from.layers[k].raster.row(r)));
    }
  }
  EXPECT_GT(compared, 70);
}

/// By tile of 16 x 16 pixels: what of a solid is material B, by its fractions or its voxels.
using TileSums = std::map<std::pair<std::int64_t, std::size_t>, double>;

TileSums sums_of_b(const Layer& layer, const BuildInfo& info, SolidId solid) {
  TileSums sums;
  MixedRowReader reader(info);
  for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
    reader.read(layer.raster, row, [&](const MixedRun& run) {
      if (run.solid != solid) return;
      const auto count = static_cast<std::size_t>(run.pixels.end - run.pixels.begin);
      for (std::size_t n = 0; n < count; ++n) {
        double& sum = sums[{(run.pixels.begin + static_cast<std::int64_t>(n)) / 16, row / 16}];
        for (std::size_t m = 0; m < run.materials.size(); ++m) {
          if (run.materials[m] == MaterialId{1}) sum += run.fractions[m * count + n];
        }
      }
    });
  }
  return sums;
}

/// The torus' skin is a gradient askew in nearly every tile; by the mask alone two of five tiles are off by more than
/// one.
TEST(Dithered, TilesHaveTheNumberOfVoxelsThatTheirFractionsAddUpTo) {
  const CollectingSink& from = sliced();
  auto inner = std::make_unique<CollectingSink>();
  CollectingSink& to = *inner;
  const auto sink = make_dither_sink(std::move(inner));
  test::feed(*sink, from.info, from.layers, from.report);
  std::size_t tiles = 0;
  std::size_t right = 0;
  for (std::size_t k = 0; k < to.layers.size(); ++k) {
    const TileSums wanted = sums_of_b(from.layers[k], from.info, SolidId{1});
    TileSums found = sums_of_b(to.layers[k], to.info, SolidId{1});
    for (const auto& [tile, sum] : wanted) {
      ++tiles;
      right += std::abs(found[tile] - sum) < 1.0 ? 1 : 0;
    }
  }
  EXPECT_GT(tiles, 300U);
  EXPECT_GT(static_cast<double>(right), 0.97 * static_cast<double>(tiles)) << tiles;
}

TEST(Dithered, PicturesAreTheSameForAnyNumberOfThreads) {
  const GradedScene scene(0.25, false);
  const test::TemporaryFolder folder;
  for (const int threads : {1, 2, 4}) {
    const auto sink = make_dither_sink(make_indexed_png_sink(folder / std::to_string(threads)));
    (void)scene.slice_into(*sink, threads);
  }
  const auto one = test::contents(folder / "1");
  EXPECT_GT(one.size(), 20U);
  EXPECT_EQ(one, test::contents(folder / "2"));
  EXPECT_EQ(one, test::contents(folder / "4"));
}

TEST(GradedVdb, DensitiesAreFractions) {
  openvdb::initialize();
  const CollectingSink& from = sliced();
  const test::TemporaryFolder folder;
  const auto sink = make_vdb_sink(folder / "v.vdb", {});
  test::feed(*sink, from.info, from.layers, from.report);
  openvdb::io::File file((folder / "v.vdb").string());
  file.open(false);
  const auto a = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density_A"));
  const auto b = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density_B"));
  const auto all = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
  std::size_t voxels = 0;
  double sum_a = 0.0;
  for (auto voxel = all->cbeginValueOn(); voxel; ++voxel) {
    openvdb::CoordBBox box;
    voxel.getBoundingBox(box);
    for (auto at = box.beginZYX(); at; ++at) {
      const float share = a->getAccessor().getValue(*at);
      ASSERT_NEAR(share + b->getAccessor().getValue(*at), 1.0F, 1e-5F);
      sum_a += share;
      ++voxels;
    }
  }
  EXPECT_GT(voxels, 100'000U);
  EXPECT_NEAR(sum_a * 1e-3, from.report.materials[MaterialId{0}].volume, 2.0);
}

/// Voxels of B less what the field says, over a cube of 32 voxels from `corner` on, as a part of them. `lower` is the
/// lattice's origin; `field` gives the fraction of B at a voxel's centre.
double mean_error(const openvdb::FloatGrid& b, const openvdb::Coord& corner, const Grid& grid,
                  const std::function<double(const Vec3&)>& field) {
  const auto at = b.getConstAccessor();
  double error = 0.0;
  const openvdb::CoordBBox cube = openvdb::CoordBBox::createCube(corner, 32);
  for (auto voxel = cube.beginZYX(); voxel; ++voxel) {
    const Vec3 place((*voxel).x() + 0.5, (*voxel).y() + 0.5, (*voxel).z() + 0.5);
    error += at.getValue(*voxel) - field(grid.origin + place.cwiseProduct(grid.pitch));
  }
  return error / static_cast<double>(cube.volume());
}

/// Over cubes within a solid, as an exporter wrote them: of the box, which is graded along z, and of the sphere, which
/// is by a formula, with a wave along y and a jump.
TEST(Dithered, MeansOfCubesAreTheFields) {
  openvdb::initialize();
  const CollectingSink& from = sliced();
  const test::TemporaryFolder folder;
  const auto sink = make_dither_sink(make_vdb_sink(folder / "v.vdb", {}));
  test::feed(*sink, from.info, from.layers, from.report);
  openvdb::io::File file((folder / "v.vdb").string());
  file.open(false);
  const auto b = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density_B"));
  const Grid& grid = from.info.plan.grid;
  const auto voxel_at = [&](const Vec3& point) {
    const Vec3 place = (point - grid.origin).cwiseQuotient(grid.pitch).array().round();
    return openvdb::Coord(static_cast<int>(place.x()), static_cast<int>(place.y()), static_cast<int>(place.z()));
  };
  const auto along_z = [](const Vec3& p) { return p.z() / 8.0; };
  const auto formula = [](const Vec3& p) { return p.x() > 4.0 ? 0.2 : 0.5 - 0.3 * std::sin(p.y()); };
  std::mt19937 random(3);
  std::uniform_real_distribution<double> step(0.0, 1.0);
  const auto jitter = [&] { return Vec3(step(random), step(random), step(random)); };
  for (int round = 0; round < 200; ++round) {
    const openvdb::Coord in_box = voxel_at(0.1 * Vec3::Ones() + 4.6 * jitter());
    EXPECT_LT(std::abs(mean_error(*b, in_box, grid, along_z)), 1e-3) << in_box;
    const openvdb::Coord in_sphere =
        voxel_at(Vec3(4, 16, 4) - 1.6 * Vec3::Ones() + 0.2 * (jitter() - 0.5 * Vec3::Ones()));
    EXPECT_LT(std::abs(mean_error(*b, in_sphere, grid, formula)), 1e-3) << in_sphere;
  }
}

}  // namespace
}  // namespace lamella
