#include "slicing/slab_engine.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "tests/slicing/known_scene.h"

namespace lamella {
namespace {

using test::Ball;
using test::KnownScene;

/// Three balls in a row along x.
KnownScene three_balls() {
  KnownScene known;
  known.add(Ball{Vec3(0, 0, 0), 2}, 0, 0, "left");
  known.add(Ball{Vec3(3, 0, 0), 2}, 1, 0, "middle");
  known.add(Ball{Vec3(9, 0, 0.25), 2}, 2, 0, "right");
  return known;
}

std::vector<RayTarget> targets(const KnownScene& known, const std::vector<std::size_t>& solids) {
  std::vector<RayTarget> out;
  for (const std::size_t solid : solids) out.push_back({SolidId{solid}, known.measures[SolidId{solid}].bounds});
  return out;
}

/// Two layers with two lattices each, one along +x and one turned by 0.3.
std::vector<LayerRequest> two_layers() {
  RowLattice raster;
  raster.anchor = -2.0;
  raster.spacing = 0.125;
  raster.last_row = 32;
  RowLattice hatch;
  hatch.along = Vec2(std::cos(0.3), std::sin(0.3));
  hatch.across = Vec2(-std::sin(0.3), std::cos(0.3));
  hatch.spacing = 0.01;
  hatch.first_row = -500;
  hatch.last_row = 300;
  return {{4, 0.25, {raster, hatch}}, {5, 1.0, {raster, hatch}}};
}

std::vector<LayerSpans> cut(const SlabEngine& engine, const std::vector<LayerRequest>& slab) {
  std::vector<LayerSpans> out;
  make_layer_spans(slab, out);
  engine.cut(slab, out);
  for (std::size_t i = 0; i < slab.size(); ++i) check_layer_spans(slab[i], out[i]);
  return out;
}

void expect_equal(const SpanRows& a, const SpanRows& b) {
  ASSERT_EQ(a.row_start, b.row_start);
  for (std::size_t i = 0; i < a.spans.size(); ++i) {
    EXPECT_EQ(a.spans[i].begin, b.spans[i].begin);
    EXPECT_EQ(a.spans[i].end, b.spans[i].end);
    EXPECT_EQ(a.spans[i].solid, b.spans[i].solid);
  }
}

TEST(RayEngine, GivesTheSpansOfEveryRowInCoordinatesAlongIt) {
  const KnownScene known = three_balls();
  const std::vector<LayerRequest> slab = two_layers();
  const std::vector<LayerSpans> out = cut(make_ray_engine(known.caster(), targets(known, {0, 1, 2})), slab);
  for (std::size_t i = 0; i < slab.size(); ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const RowLattice& lattice = slab[i].lattices[k];
      for (std::size_t r = 0; r < lattice.rows(); ++r) {
        const double offset = lattice.position(lattice.first_row + static_cast<std::int64_t>(r));
        std::size_t met = 0;
        for (const double x : {0.0, 3.0, 9.0}) {
          const Vec2 center(x, 0.0);
          const double z = slab[i].z - (x == 9.0 ? 0.25 : 0.0);
          const double square = 4.0 - z * z - std::pow(lattice.across.dot(center) - offset, 2);
          if (square <= 0.0) continue;
          const Span& span = out[i].lattices[k].row(r)[met++];
          EXPECT_NEAR(span.begin, lattice.along.dot(center) - std::sqrt(square), 1e-7);
          EXPECT_NEAR(span.end, lattice.along.dot(center) + std::sqrt(square), 1e-7);
        }
        ASSERT_EQ(out[i].lattices[k].row(r).size(), met);
      }
    }
    EXPECT_EQ(out[i].cast.hits, 2 * (out[i].lattices[0].spans.size() + out[i].lattices[1].spans.size()));
  }
}

TEST(JoinedEngines, GiveWhatOneEngineForAllSolidsGives) {
  const KnownScene known = three_balls();
  const std::vector<LayerRequest> slab = two_layers();
  const SlabEngine all = make_ray_engine(known.caster(), targets(known, {0, 1, 2}));
  SlabEngine outer = make_ray_engine(known.caster(), targets(known, {0, 2}));
  outer.slab_layers = kSlabLayers;
  const SlabEngine joined = join_engines(outer, make_ray_engine(known.caster(), targets(known, {1})));
  EXPECT_EQ(joined.slab_layers, kSlabLayers);
  const std::vector<LayerSpans> expected = cut(all, slab);
  const std::vector<LayerSpans> out = cut(joined, slab);
  for (std::size_t i = 0; i < slab.size(); ++i) {
    EXPECT_EQ(out[i].cast.hits, expected[i].cast.hits);
    for (std::size_t k = 0; k < 2; ++k) expect_equal(out[i].lattices[k], expected[i].lattices[k]);
  }
}

TEST(JoinedEngines, TellTheFindingsOfBoth) {
  SlabEngine first;
  SlabEngine second;
  EXPECT_TRUE(join_engines(first, second).findings().empty());
  first.findings = [] { return std::vector<Finding>{{Severity::warning, {}, {}, {}, "one", {}}}; };
  second.findings = [] { return std::vector<Finding>{{Severity::warning, {}, {}, {}, "two", {}}}; };
  const std::vector<Finding> findings = join_engines(first, second).findings();
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].what, "one");
  EXPECT_EQ(findings[1].what, "two");
}

TEST(SortSpans, OrdersByBeginThenEndThenSolidAndSurvivesNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto span = [](double begin, double end, std::size_t solid) {
    return Span{begin, end, SolidId{solid}, FaceId{}, FaceId{}};
  };
  std::vector<Span> row{span(2, 3, 0), span(1, 4, 2), span(1, 3, 1), span(1, 4, 1)};
  sort_spans(row);
  EXPECT_EQ(row[0].end, 3.0);
  EXPECT_EQ(row[1].solid, SolidId{1});
  EXPECT_EQ(row[2].solid, SolidId{2});
  EXPECT_EQ(row[3].begin, 2.0);
  std::vector<Span> broken;
  for (int i = 0; i < 100; ++i) broken.push_back(span(i % 3 == 0 ? nan : 100 - i, nan, 0));
  sort_spans(broken);
  EXPECT_EQ(broken.size(), 100u);
}

TEST(CheckLayerSpans, RefusesMissingRowsAndBrokenStarts) {
  const LayerRequest request = two_layers().front();
  std::vector<LayerSpans> out;
  make_layer_spans(std::span(&request, 1), out);
  EXPECT_THROW(check_layer_spans(request, out[0]), GeometryError) << "no rows at all";
  for (std::size_t k = 0; k < 2; ++k) out[0].lattices[k].row_start.assign(request.lattices[k].rows() + 1, 0);
  EXPECT_NO_THROW(check_layer_spans(request, out[0]));
  out[0].lattices[1].row_start.back() = 1;
  EXPECT_THROW(check_layer_spans(request, out[0]), GeometryError) << "more spans than there are";
  out[0].lattices[1].row_start.back() = 0;
  out[0].lattices[1].row_start[3] = 5;
  EXPECT_THROW(check_layer_spans(request, out[0]), GeometryError) << "starts that fall";
}

}  // namespace
}  // namespace lamella
