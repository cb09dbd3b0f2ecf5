#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <random>

#include "core/error.h"
#include "materials/compositions.h"
#include "materials/material_rules.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;

/// A folder with a materials file that makes everything of the graded material with this field.
class GradedFolder {
 public:
  explicit GradedFolder(const std::string& field, const std::string& components = kTwo) {
    std::ofstream(folder_ / "m.xml") << "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.2\">\n<library>\n"
                                     << "<material name=\"A\"/><material name=\"B\"/><material name=\"C\"/>\n"
                                     << "<graded name=\"mix\">" << components << "\n"
                                     << field
                                     << "\n</graded>\n</library>\n<assignments default=\"mix\"/></materials>\n";
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] MaterialRules read() const { return read_material_rules(folder_ / "m.xml"); }

  static constexpr const char* kTwo = "<component material=\"A\"/><component material=\"B\"/>";
  static constexpr const char* kThree =
      "<component material=\"A\"/><component material=\"B\"/><component material=\"C\"/>";

 private:
  test::TemporaryFolder folder_;
};

/// The share of the second component at points of a scene's first solid.
class Mix {
 public:
  Mix(const Scene& scene, const MaterialRules& rules)
      : compositions_(scene, assign_materials(scene, rules)), probe_(compositions_) {}
  double at(const Vec3& point, SolidId solid = SolidId{0}) {
    probe_.start(solid);
    std::vector<double> fractions(compositions_.components(solid));
    fault_ = probe_.sample(point, fractions);
    double sum = 0.0;
    for (const double fraction : fractions) {
      EXPECT_GE(fraction, 0.0);
      sum += fraction;
    }
    EXPECT_NEAR(sum, 1.0, 1e-15);
    return fractions[1];
  }
  [[nodiscard]] double fault() const { return fault_; }

 private:
  Compositions compositions_;
  Compositions::Probe probe_;
  double fault_ = 0.0;
};

constexpr const char* kStops = "<stop at=\"0\" fractions=\"1 0\"/><stop at=\"10\" fractions=\"0 1\"/>";

std::string with_stops(const std::string& tag) {
  return "<" + tag + ">" + kStops + "</" + tag.substr(0, tag.find(' ')) + ">";
}

InputError refusal(const GradedFolder& folder, const Scene& scene) {
  try {
    const Mix mix(scene, folder.read());
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "accepted";
  return InputError("accepted");
}

Scene box() { return test::scene_of(test::add_box, Vec3(0, 0, 0), Vec3(20, 20, 20)); }

TEST(Graded, AxisTakesTheWayAlongItsDirection) {
  const Scene scene = box();
  Mix mix(scene, GradedFolder(with_stops("axis origin=\"1 0 0\" direction=\"3 0 4\"")).read());
  EXPECT_NEAR(mix.at({1, 5, 0}), 0.0, 1e-15);
  EXPECT_NEAR(mix.at({1 + 3, 7, 4}), 0.5, 1e-15);
  EXPECT_EQ(mix.at({20, 0, 20}), 1.0);
  EXPECT_EQ(mix.at({-5, 0, 0}), 0.0);
}

TEST(Graded, RadialTakesTheDistanceFromAnAxisOrAPoint) {
  const Scene scene = box();
  Mix around(scene, GradedFolder(with_stops("radial origin=\"1 1 0\" direction=\"0 0 1\"")).read());
  EXPECT_NEAR(around.at({4, 5, 17}), 0.5, 1e-15);
  Mix ball(scene, GradedFolder(with_stops("radial origin=\"1 1 1\"")).read());
  EXPECT_NEAR(ball.at({3, 4, 7}), 0.7, 1e-15);
}

TEST(Graded, DistanceIsThatOfTheExactSurface) {
  Scene scene;
  test::add_sphere(scene, 12.0);
  Mix mix(scene, GradedFolder(with_stops("distance")).read());
  for (const double radius : {11.9, 9.0, 7.5, 2.5}) {
    const Vec3 point = radius * Vec3(0.48, -0.6, 0.64);
    EXPECT_NEAR(mix.at(point), 0.1 * (12.0 - radius), 1e-13);
  }
  EXPECT_EQ(mix.at({0.5, 0, 0}), 1.0);
}

TEST(Graded, DistanceFromNamedFaces) {
  Scene scene = box();
  for (Face& face : scene.faces) {
    const Plane& plane = std::get<Plane>(face.surface);
    const bool is_top = std::abs(plane.frame.origin.z() - 20.0) < 1e-9 && std::abs(plane.frame.z.z()) > 0.9;
    face.name = is_top ? "top face" : "side";
  }
  Mix mix(scene, GradedFolder(with_stops("distance faces=\"top*\"")).read());
  EXPECT_NEAR(mix.at({0.1, 3, 14}), 0.6, 1e-13);
  EXPECT_NEAR(mix.at({10, 10, 19}), 0.1, 1e-13);
  const InputError error = refusal(GradedFolder(with_stops("distance faces=\"bottom\"")), scene);
  EXPECT_THAT(error.what(), HasSubstr("'bottom'"));
  EXPECT_THAT(error.hint(), HasSubstr("'side', 'top face'"));
  EXPECT_THAT(error.where(), HasSubstr("m.xml:5"));
}

TEST(Graded, AMovedCopyHasTheSameField) {
  Scene scene;
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 shift(100, -20, 3);
  const auto add = [&](const Mat3& linear, const Vec3& translation, const char* name) {
    test::SolidOptions options;
    options.placement = {linear, translation};
    options.name = name;
    const SolidId id = test::add_box(scene, {0, 0, 0}, {20, 20, 20}, options).id;
    scene.solids[id].info.instance = Instance{4, linear, translation};
  };
  add(Mat3::Identity(), Vec3(1, 1, 1), "first");
  add(turn, shift, "second");
  for (const char* field : {"axis direction=\"1 2 1\"", "radial origin=\"3 3 3\"", "distance"}) {
    Mix mix(scene, GradedFolder(with_stops(field)).read());
    for (const Vec3& part : {Vec3(1, 2, 3), Vec3(15, 4, 9), Vec3(19, 19, 6)}) {
      const double first = mix.at(part + Vec3(1, 1, 1), SolidId{0});
      EXPECT_NEAR(mix.at(turn * part + shift, SolidId{1}), first, 1e-12) << field;
    }
  }
}

TEST(Graded, ATableIsReadFromAFile) {
  const GradedFolder folder("<axis table=\"t.csv\"/>", GradedFolder::kThree);
  folder.write("t.csv", "position,A,B,C\n# a remark\n0, 1, 0, 0\n\n10; 0; 1; 0\n10 0 0 1\n30\t0\t0.5\t0.5\n");
  const Scene scene = box();
  Mix mix(scene, folder.read());
  EXPECT_NEAR(mix.at({0, 0, 4}), 0.4, 1e-15);
  EXPECT_NEAR(mix.at({0, 0, 10.0}), 0.0, 1e-15);
  EXPECT_NEAR(mix.at({0, 0, 20}), 0.25, 1e-15);
}

TEST(Graded, ATableThatCantBeUsedIsRefusedByLine) {
  const Scene scene = box();
  const std::pair<const char*, const char*> cases[] = {{"0,1,0\n5,1\n", ":2"},       {"0,1,0\n-1,1,0\n", ":2"},
                                                       {"0,1,0\n1,0.6,0.6\n", ":2"}, {"a,b,c\n\n0,1,zero\n", ":3"},
                                                       {"0,1,0\n1,nan,0\n", ":2"},   {"0,-1,2\n", ":1"}};
  for (const auto& [text, line] : cases) {
    const GradedFolder folder("<axis table=\"t.csv\"/>");
    folder.write("t.csv", text);
    EXPECT_THAT(refusal(folder, scene).where(), HasSubstr(std::string("t.csv") + line)) << text;
  }
  EXPECT_THAT(refusal(GradedFolder("<axis table=\"none.csv\"/>"), scene).where(), HasSubstr("none.csv"));
  EXPECT_THAT(refusal(GradedFolder("<axis table=\"/dev/zero\"/>"), scene).what(), HasSubstr("can't read"));
  const GradedFolder endless("<axis table=\"t.csv\"/>");
  endless.write("t.csv", std::string(1 << 20, '1'));
  EXPECT_THAT(refusal(endless, scene).what(), HasSubstr("64 KiB"));
}

TEST(Graded, FormulasSeeThePartsFrame) {
  const Scene scene = box();
  Mix two(scene, GradedFolder("<expression><fraction>1 - x / 20</fraction></expression>").read());
  EXPECT_NEAR(two.at({5, 1, 1}), 0.25, 1e-15);
  Mix all(scene, GradedFolder("<expression><fraction>y &lt; 10 ? 1 : 0</fraction><fraction>y &lt; 10 ? 0 : 1</fraction>"
                              "</expression>")
                     .read());
  EXPECT_EQ(all.at({5, 9, 1}), 0.0);
  EXPECT_EQ(all.at({5, 11, 1}), 1.0);
  Mix depth(scene, GradedFolder("<expression><fraction>1 - min(d, 5) / 5</fraction></expression>").read());
  EXPECT_NEAR(depth.at({10, 2, 10}), 0.4, 1e-13);
  Mix radius(scene, GradedFolder("<expression><fraction>1 - r / 50</fraction></expression>").read());
  EXPECT_NEAR(radius.at({3, 4, 10}), 0.1, 1e-15);
  EXPECT_LT(radius.fault(), kFractionSlack);
}

TEST(Graded, FormulasThatLeaveTheRangeArePutRightAndCounted) {
  const Scene scene = box();
  Mix mix(scene,
          GradedFolder("<expression><fraction>x</fraction><fraction>sqrt(5 - y)</fraction></expression>").read());
  EXPECT_NEAR(mix.at({3, 4, 0}), 0.25, 1e-15);
  EXPECT_GT(mix.fault(), kFractionSlack);
  EXPECT_EQ(mix.at({0.5, 6, 0}), 0.0);  // the root of a negative number
  EXPECT_GT(mix.fault(), kFractionSlack);
}

TEST(Graded, HostileFormulasAreRefused) {
  const Scene scene = box();
  const std::string deep(2000, '(');
  for (const std::string& text : {std::string("x +"), std::string("foo(x)"), std::string("q"), std::string("1, 2"),
                                  std::string("\"a\""), deep, std::string(5000, '1'), std::string("system(1)")}) {
    const InputError error = refusal(GradedFolder("<expression><fraction>" + text + "</fraction></expression>"), scene);
    EXPECT_THAT(error.where(), HasSubstr("m.xml:5")) << text.substr(0, 20);
    EXPECT_FALSE(error.hint().empty());
  }
  // An assignment changes nothing for the next formula.
  Mix mix(scene,
          GradedFolder("<expression><fraction>x = 0.25</fraction><fraction>1 - x / 4</fraction></expression>").read());
  EXPECT_NEAR(mix.at({1, 0, 0}), 0.75, 1e-15);
}

void write_grid(const std::filesystem::path& path, const openvdb::GridBase::Ptr& grid) {
  grid->setName("share");
  openvdb::io::File(path.string()).write({grid});
}

TEST(Graded, GridsAreTrilinearInMillimetres) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0.0f);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(2.0));
  const auto linear = [](const Vec3& p) { return 0.1 + 0.02 * p.x() + 0.01 * p.y() - 0.015 * p.z(); };
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) {
      for (int k = 0; k < 3; ++k) {
        const double share = 1.0 - linear({2.0 * i, 2.0 * j, 2.0 * k});
        grid->getAccessor().setValue({i, j, k}, static_cast<float>(share));
      }
    }
  }
  const GradedFolder folder("<grid file=\"g.vdb\"><fraction grid=\"share\"/></grid>");
  write_grid(folder.path("g.vdb"), grid);
  const Scene scene = box();
  Mix mix(scene, folder.read());
  for (const Vec3& point : {Vec3(3, 5, 1), Vec3(7.3, 11.1, 2.9), Vec3(0, 4, 4)}) {
    EXPECT_NEAR(mix.at(point), linear(point), 2e-7);
  }
}

TEST(Graded, GridsThatCantBeUsedAreRefused) {
  openvdb::initialize();
  const Scene scene = box();
  const GradedFolder folder("<grid file=\"g.vdb\"><fraction grid=\"share\"/></grid>");
  EXPECT_THAT(refusal(folder, scene).what(), HasSubstr("can't read"));
  write_grid(folder.path("g.vdb"), openvdb::Int32Grid::create(0));
  EXPECT_THAT(refusal(folder, scene).what(), HasSubstr("floats"));
  std::string bytes;
  {
    write_grid(folder.path("g.vdb"), openvdb::FloatGrid::create(0.0f));
    std::ifstream stream(folder.path("g.vdb"), std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(stream), {});
  }
  EXPECT_NO_THROW(Mix(scene, folder.read()));
  for (std::size_t length = 0; length < bytes.size(); length += 7) {
    folder.write("g.vdb", bytes.substr(0, length));
    EXPECT_THROW(Mix(scene, folder.read()), InputError) << length;
  }
  const GradedFolder other("<grid file=\"g.vdb\"><fraction grid=\"none\"/></grid>");
  write_grid(other.path("g.vdb"), openvdb::FloatGrid::create(0.0f));
  EXPECT_THAT(refusal(other, scene).hint(), HasSubstr("'share'"));
}

/// A field of materials.xml and what else it needs.
struct WrittenField {
  const char* name;
  std::string field;
  const char* components = GradedFolder::kTwo;
};

class WrittenBack : public ::testing::TestWithParam<WrittenField> {};

/// The file that is written for another folder gives every point of every solid the same fractions.
TEST_P(WrittenBack, GivesTheSameFractions) {
  openvdb::initialize();
  Scene scene = test::scene_of(test::add_box, Vec3(0, 0, 0), Vec3(8, 7, 6));
  test::add_sphere(scene, 3.0, {test::Placement::at(Vec3(20, 3, 3)), "ball", "", {}});
  const GradedFolder folder(GetParam().field, GetParam().components);
  folder.write("t.csv", "mm, A, B\n0; 0.1 0.9\n# between\n1e-1, 0.3, 0.7\n7, 1, 0\n");
  const auto grid = openvdb::FloatGrid::create(0.25f);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(1.5));
  for (int n = 0; n < 216; ++n) {
    grid->tree().setValue(openvdb::Coord(n % 6, n / 6 % 6, n / 36), static_cast<float>(n % 7) / 7.0f);
  }
  grid->setName("share & <more>");
  openvdb::io::File(folder.path("g.vdb").string()).write({grid});
  MaterialTable table = assign_materials(scene, folder.read());
  table.materials[MaterialId{1}].layers = {0.02, 0.05, 0.3};
  table.materials[MaterialId{3}].layers.deviation = 0.125;

  const test::TemporaryFolder other;
  std::ofstream(other / "again.xml") << starter_rules(scene, table, other.path());
  const std::string schema = (test::source_dir() / "schemas/materials.xsd").string();
  EXPECT_EQ(std::system(("xmllint --nonet --noout --schema '" + schema + "' '" + (other / "again.xml").string() +
                         "' >/dev/null 2>&1")
                            .c_str()),
            0);
  const MaterialTable again = assign_materials(scene, read_material_rules(other / "again.xml"));
  ASSERT_EQ(again.materials.size(), table.materials.size());
  for (const MaterialId id : table.materials.ids()) {
    EXPECT_EQ(again.materials[id].name, table.materials[id].name);
    EXPECT_EQ(again.materials[id].components, table.materials[id].components);
    EXPECT_EQ(again.materials[id].layers.deviation, table.materials[id].layers.deviation);
    EXPECT_EQ(again.materials[id].layers.least, table.materials[id].layers.least);
    EXPECT_EQ(again.materials[id].layers.most, table.materials[id].layers.most);
  }
  const Compositions before(scene, table);
  const Compositions after(scene, again);
  Compositions::Probe probe_before(before);
  Compositions::Probe probe_after(after);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> along(-1.0, 9.0);
  double least = 1.0;
  double most = 0.0;
  for (int i = 0; i < 300; ++i) {
    const SolidId solid{static_cast<std::size_t>(i % 2)};
    EXPECT_EQ(again.assignments[solid].material, table.assignments[solid].material);
    const Vec3 point = Vec3(along(random), along(random), along(random)) + (i % 2 == 0 ? Vec3::Zero() : Vec3(16, 0, 0));
    std::vector<double> wanted(before.components(solid));
    std::vector<double> found(after.components(solid));
    ASSERT_EQ(found.size(), wanted.size());
    probe_before.start(solid);
    probe_after.start(solid);
    (void)probe_before.sample(point, wanted);
    (void)probe_after.sample(point, found);
    for (std::size_t c = 0; c < wanted.size(); ++c) EXPECT_NEAR(found[c], wanted[c], 1e-14) << point.transpose();
    least = std::min(least, wanted[0]);
    most = std::max(most, wanted[0]);
  }
  EXPECT_GT(most - least, 0.2) << "a field that says nothing";
  EXPECT_EQ(starter_rules(scene, again, other.path()), starter_rules(scene, table, other.path()));
}

INSTANTIATE_TEST_SUITE_P(
    Fields, WrittenBack,
    ::testing::Values(
        WrittenField{"Axis", with_stops("axis origin=\"1 -2.5 1e-3\" direction=\"1 2 3\"")},
        WrittenField{"AxisOfThree",
                     "<axis direction=\"0 1 0\"><stop at=\"0\" fractions=\"0.2 0.3 0.5\"/><stop at=\"3\" "
                     "fractions=\"0.7 0.1 0.2\"/><stop at=\"3\" fractions=\"0 0 1\"/></axis>",
                     GradedFolder::kThree},
        WrittenField{"RadialAboutAnAxis", with_stops("radial origin=\"1 2 3\" direction=\"0.3 0 -1\"")},
        WrittenField{"RadialAboutAPoint", with_stops("radial origin=\"1 2 3\"")},
        WrittenField{"Distance",
                     "<distance><stop at=\"0\" fractions=\"1 0\"/><stop at=\"2\" fractions=\"0 1\"/>"
                     "</distance>"},
        WrittenField{"Table", "<axis table=\"t.csv\"/>"},
        WrittenField{"Formulas",
                     "<expression detail=\"0.5\"><fraction>x &lt; 4 ? 0.5 + 0.1 * sin(y) : z / 20</fraction>"
                     "<fraction>0.2 * exp(-d)</fraction></expression>",
                     GradedFolder::kThree},
        WrittenField{"Grid", "<grid file=\"g.vdb\"><fraction grid=\"share &amp; &lt;more&gt;\"/></grid>"}),
    [](const auto& one) { return one.param.name; });

TEST(Graded, WhatItIsMadeOfMustBeThere) {
  const Scene scene = box();
  const auto what = [&](const std::string& components, const std::string& field) {
    return std::string(refusal(GradedFolder(field, components), scene).what());
  };
  const std::string stops = with_stops("axis");
  EXPECT_THAT(what("<component material=\"A\"/><component material=\"Z\"/>", stops), HasSubstr("'Z' isn't"));
  EXPECT_THAT(what("<component material=\"A\"/><component material=\"A\"/>", stops), HasSubstr("twice"));
  EXPECT_THAT(what("<component material=\"A\"/>", stops), HasSubstr("1 components"));
  EXPECT_THAT(what("<component material=\"A\"/><component material=\"mix\"/>", stops), HasSubstr("'mix' isn't"));
  EXPECT_THAT(what(GradedFolder::kThree, stops), HasSubstr("2 fractions for 3"));
  EXPECT_THAT(what(GradedFolder::kTwo, "<axis><stop at=\"0\" fractions=\"0.5 0.6\"/></axis>"), HasSubstr("sum 1"));
  EXPECT_THAT(what(GradedFolder::kTwo, "<axis/>"), HasSubstr("either"));
  EXPECT_THAT(what(GradedFolder::kThree, "<expression><fraction>1</fraction></expression>"),
              HasSubstr("1 formulas for 3"));
}

}  // namespace
}  // namespace lamella
