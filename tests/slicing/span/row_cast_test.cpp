/// Rows of hand-made sections against a scan of each row by itself: every crossing computed, sorted and summed up.

#include "slicing/span/row_cast.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <tuple>

#include "tests/slicing/span/hand_made_section.h"

namespace lamella::span {
namespace {

/// A scene of nameless solids, each of as many faces.
Scene scene_of(std::size_t solids, std::size_t faces_each) {
  Scene scene;
  for (std::size_t s = 0; s < solids; ++s) {
    scene.solids.push_back({});
    Shell shell;
    shell.solid = SolidId{s};
    scene.shells.push_back(shell);
    for (std::size_t f = 0; f < faces_each; ++f) {
      Face face;
      face.shell = ShellId{s};
      scene.faces.push_back(face);
    }
  }
  return scene;
}

using Failure = std::tuple<Check, SolidId, FaceId>;

struct Expected {
  std::vector<std::vector<Span>> rows;
  CastCounters cast;
  std::map<Failure, std::pair<std::uint64_t, double>> failed;

  void note(Check check, SolidId solid, FaceId face, double length) {
    auto& [count, longest] = failed[{check, solid, face}];
    ++count;
    longest = std::max(longest, length);
  }
};

struct Crossing {
  double x;
  std::uint32_t tag;
  FaceId face;
};

std::vector<Crossing> crossings_of(const Scene& scene, const Section& section, SolidId solid, double row) {
  std::vector<Crossing> found;
  for (std::uint32_t i = 0; i < section.arcs.size(); ++i) {
    const SectionArc& arc = section.arcs[i];
    if (scene.solid_of(arc.face) != solid || (arc.begin.y() <= row) == (arc.end.y() <= row)) continue;
    const ArcPiece& piece = section.pieces[arc.first_piece];
    const double t = (row - piece.y[0]) * (1.0 / piece.y[1]);
    const bool rises = arc.begin.y() < arc.end.y();
    found.push_back({piece.x[0] + std::clamp(t, 0.0, 1.0) * piece.x[1], 2 * i + (rises ? 1U : 0U), arc.face});
  }
  std::sort(found.begin(), found.end(),
            [](const Crossing& a, const Crossing& b) { return std::tie(a.x, a.tag) < std::tie(b.x, b.tag); });
  return found;
}

void scan_row(const Scene& scene, const Section& section, SolidId solid, double row, Expected& expected) {
  int winding = 0;
  double off_since = 0.0;
  const auto is_off = [](int value) { return value < 0 || value > 1; };
  for (const Crossing& hit : crossings_of(scene, section, solid, row)) {
    ++expected.cast.hits;
    const int before = winding;
    winding += (hit.tag & 1) != 0 ? -1 : 1;
    if (before == 0 && winding == 1) expected.rows.back().push_back({hit.x, hit.x, solid, hit.face, {}});
    if (before == 1 && winding == 0) {
      expected.rows.back().back().end = hit.x;
      expected.rows.back().back().face_out = hit.face;
    }
    if (!is_off(before) && is_off(winding)) off_since = hit.x;
    if (is_off(before) && !is_off(winding) && hit.x - off_since > 1e-6) {
      ++expected.cast.repaired_rays;
      expected.note(Check::winding, solid, hit.face, hit.x - off_since);
    }
  }
  if (winding == 0) return;
  ++expected.cast.unclosed_rays;
  expected.note(Check::closure, solid, {}, 0.0);
}

Expected scan(const Scene& scene, const Section& section, const RowLattice& lattice) {
  Expected expected;
  for (std::int64_t m = lattice.first_row; m < lattice.last_row; ++m) {
    expected.rows.emplace_back();
    for (const SolidId solid : scene.solids.ids()) {
      scan_row(scene, section, solid, lattice.position(m), expected);
    }
    std::stable_sort(expected.rows.back().begin(), expected.rows.back().end(), [](const Span& a, const Span& b) {
      return std::tie(a.begin, a.end, a.solid) < std::tie(b.begin, b.end, b.solid);
    });
  }
  return expected;
}

void expect_same(const LayerSpans& found, const Expected& expected) {
  EXPECT_EQ(found.cast.hits, expected.cast.hits);
  EXPECT_EQ(found.cast.unclosed_rays, expected.cast.unclosed_rays);
  EXPECT_EQ(found.cast.repaired_rays, expected.cast.repaired_rays);
  const SpanRows& rows = found.lattices.front();
  ASSERT_EQ(rows.rows(), expected.rows.size());
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    ASSERT_EQ(rows.row(r).size(), expected.rows[r].size()) << "row " << r;
    for (std::size_t k = 0; k < rows.row(r).size(); ++k) {
      const auto fields = [](const Span& s) { return std::tie(s.begin, s.end, s.solid, s.face_in, s.face_out); };
      EXPECT_EQ(fields(rows.row(r)[k]), fields(expected.rows[r][k])) << "row " << r << " span " << k;
    }
  }
  ASSERT_EQ(found.failed.size(), expected.failed.size());
  for (const FailedCheck& failed : found.failed) {
    const auto same = expected.failed.find({failed.check, failed.solid, failed.face});
    ASSERT_NE(same, expected.failed.end());
    EXPECT_EQ(failed.count, same->second.first);
    EXPECT_EQ(failed.longest, same->second.second);
  }
}

LayerSpans cast(const Scene& scene, const Section& section, const RowLattice& lattice) {
  LayerSpans found;
  found.lattices.resize(1);
  RowCast(scene).cast(section, lattice, 0, found);
  return found;
}

/// Polygons with corners on whole numbers, for many ties; of `open` arcs one is left out.
Section random_polygons(std::mt19937_64& random, const Scene& scene, bool turns, bool open) {
  Section section;
  for (const FaceId face : scene.faces.ids()) {
    const auto whole = [&](std::uint64_t count) { return static_cast<double>(random() % count); };
    const std::size_t first = section.arcs.size();
    if (turns) {
      std::vector<Vec2> corners(3 + random() % 5);
      for (Vec2& corner : corners) corner = {whole(7), whole(40)};
      test::add_polygon(section, corners);
    } else {
      const Vec2 low(4.0 * face.value() + whole(2), whole(20));
      const Vec2 high = low + Vec2(1.0 + whole(3), 1.0 + whole(20));
      test::add_polygon(section, {low, {high.x(), low.y()}, high, {low.x(), high.y()}});
    }
    for (std::size_t i = first; i < section.arcs.size(); ++i) section.arcs[i].face = face;
  }
  if (open) section.arcs.erase(section.arcs.begin() + static_cast<std::ptrdiff_t>(random() % section.arcs.size()));
  return section;
}

TEST(RowCast, GivesWhatScanningEachRowGives) {
  std::mt19937_64 random(1);
  const Scene scene = scene_of(4, 3);
  std::size_t repaired = 0, unclosed = 0, spans = 0;
  for (int k = 0; k < 600; ++k) {
    const Section section = random_polygons(random, scene, k % 2 == 0, k % 5 == 0);
    RowLattice lattice;
    lattice.spacing = k % 3 == 0 ? 0.125 : 0.3;
    lattice.anchor = k % 3 == 0 ? -0.0625 : -0.01;  // through the corners, and beside them
    lattice.first_row = -5;
    lattice.last_row = 330;
    const LayerSpans found = cast(scene, section, lattice);
    expect_same(found, scan(scene, section, lattice));
    if (HasFailure()) FAIL() << "section " << k;
    repaired += found.cast.repaired_rays;
    unclosed += found.cast.unclosed_rays;
    spans += found.lattices.front().spans.size();
  }
  EXPECT_GT(repaired, 1000U);
  EXPECT_GT(unclosed, 1000U);
  EXPECT_GT(spans, 100'000U);
}

TEST(RowCast, KeepsManyColumnsInOrder) {
  // More begin together than are sorted one by one, and walls lean so that neighbours of different solids change
  // places.
  const Scene scene = scene_of(40, 1);
  Section section;
  for (const FaceId face : scene.faces.ids()) {
    const double x = 3.0 * ((face.value() * 7U) % 40U);
    const double lean = face.value() % 2 == 0 ? 1.5 : -1.5;
    const std::size_t first = section.arcs.size();
    test::add_polygon(section, {{x, 1.0}, {x + 2.5, 1.0}, {x + 2.5 + lean, 30.0}, {x + lean, 30.0}});
    for (std::size_t i = first; i < section.arcs.size(); ++i) section.arcs[i].face = face;
  }
  RowLattice lattice;
  lattice.spacing = 0.25;
  lattice.last_row = 130;
  const LayerSpans found = cast(scene, section, lattice);
  expect_same(found, scan(scene, section, lattice));
  EXPECT_EQ(found.cast.hits, 80U * 116U);
}

TEST(RowCast, CountsEveryHitOfADoubtfulArc) {
  const Scene scene = scene_of(1, 2);
  Section section;
  test::add_polygon(section, {{0, 0}, {2, 0}, {2, 10}, {0, 10}});
  section.arcs[1].face = FaceId{1};
  section.arcs[1].doubtful = true;
  RowLattice lattice;
  lattice.last_row = 12;
  const LayerSpans found = cast(scene, section, lattice);
  EXPECT_EQ(found.cast.hits, 20U);
  EXPECT_EQ(found.cast.uncertain_hits, 10U);
  ASSERT_EQ(found.failed.size(), 1U);
  EXPECT_EQ(found.failed.front().check, Check::arcs);
  EXPECT_EQ(found.failed.front().face, FaceId{1});
  EXPECT_EQ(found.failed.front().count, 10U);
}

TEST(RowCast, GivesRowsWithoutSpansWhereThereIsNoSection) {
  const Scene scene = scene_of(1, 1);
  RowLattice lattice;
  for (const std::int64_t rows : {0, 5}) {
    lattice.last_row = rows;
    const LayerSpans found = cast(scene, {}, lattice);
    EXPECT_EQ(found.lattices.front().rows(), static_cast<std::size_t>(rows));
    EXPECT_TRUE(found.lattices.front().spans.empty());
  }
}

}  // namespace
}  // namespace lamella::span
