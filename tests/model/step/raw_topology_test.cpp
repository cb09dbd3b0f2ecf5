#include "model/step/raw_topology.h"

#include <array>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lamella::step {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A tetrahedron as text: solid #1, shell #2, faces #11 to #14, edges #31 to #36.
struct Tetrahedron {
  // Corners 0..3; each face a loop of directed edges, outward.
  static constexpr std::array<std::array<int, 2>, 6> kEdges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  struct Use {
    int edge;
    bool forward;
  };
  std::array<std::vector<Use>, 4> faces = {{{{2, false}, {1, false}, {0, false}},
                                            {{0, true}, {4, true}, {3, false}},
                                            {{1, true}, {5, true}, {4, false}},
                                            {{2, true}, {3, true}, {5, false}}}};
  std::array<bool, 4> bound_forward = {true, true, true, true};
  std::string shell_kind = "CLOSED_SHELL";
  int faces_used = 4;

  [[nodiscard]] std::string text() const {
    std::string data = "#1=MANIFOLD_SOLID_BREP('tetra',#2);#2=" + shell_kind + "('',(";
    for (int f = 0; f < faces_used; ++f) data += (f > 0 ? ",#1" : "#1") + std::to_string(f + 1);
    data += "));";
    int oriented = 100;
    for (int f = 0; f < 4; ++f) {
      const std::string n = std::to_string(f + 1);
      data += "#1" + n + "=ADVANCED_FACE('',(#4" + n + "),#5" + n + ",.T.);#4" + n + "=FACE_OUTER_BOUND('',#6" + n +
              "," + (bound_forward[f] ? ".T." : ".F.") + ");#6" + n + "=EDGE_LOOP('',(";
      std::string uses;
      for (std::size_t k = 0; k < faces[f].size(); ++k) {
        const std::string id = "#" + std::to_string(oriented++);
        data += (k > 0 ? "," : "") + id;
        uses += id + "=ORIENTED_EDGE('',*,*,#3" + std::to_string(faces[f][k].edge + 1) + "," +
                (faces[f][k].forward ? ".T." : ".F.") + ");";
      }
      data += "));" + uses;
    }
    for (int e = 1; e <= 6; ++e)
      data += "#3" + std::to_string(e) + "=EDGE_CURVE('',$,$,#7" + std::to_string(e) + ",.T.);";
    return "ISO-10303-21;HEADER;ENDSEC;DATA;" + data + "ENDSEC;END-ISO-10303-21;";
  }
};

std::vector<RawFault> faults_of(const Tetrahedron& solid) {
  const std::string text = solid.text();
  const Part21 file(text);
  EXPECT_THAT(file.faults(), IsEmpty());
  return RawTopology(file).faults();
}

TEST(RawTopology, FindsNothingWrongWithASoundSolid) {
  const std::string text = Tetrahedron().text();
  const Part21 file(text);
  const RawTopology topology(file);
  EXPECT_THAT(topology.faults(), IsEmpty());
  ASSERT_THAT(topology.solids(), SizeIs(1));
  EXPECT_THAT(topology.solids()[0].shells.at(0).faces, SizeIs(4));
  EXPECT_EQ(topology.face_of(61), 11) << "a loop";
  EXPECT_EQ(topology.face_of(51), 11) << "a surface";
  EXPECT_EQ(topology.face_of(71), 11) << "an edge's curve, by the first face";
  EXPECT_EQ(topology.solid_of(13), 1);
}

TEST(RawTopology, NamesEveryMissingFace) {
  Tetrahedron open;
  open.faces_used = 3;
  const auto faults = faults_of(open);
  ASSERT_THAT(faults, SizeIs(1));
  EXPECT_TRUE(faults[0].breaks);
  EXPECT_EQ(faults[0].solid, 1);
  EXPECT_THAT(faults[0].what, HasSubstr("3 edges used by one face only"));
}

TEST(RawTopology, NamesAFlippedFaceByItsBoundOrItsEdges) {
  for (int f = 0; f < 4; ++f) {
    Tetrahedron flipped;
    flipped.bound_forward[f] = false;
    const auto faults = faults_of(flipped);
    ASSERT_THAT(faults, SizeIs(1)) << f;
    EXPECT_THAT(faults[0].what, HasSubstr("3 edges run through twice in one sense"));
    for (auto& use : flipped.faces[f]) use.forward = !use.forward;
    EXPECT_THAT(faults_of(flipped), IsEmpty()) << "two turns are none";
  }
}

TEST(RawTopology, NamesAnOpenShellUnderASolidThoughItsEdgesClose) {
  Tetrahedron misnamed;
  misnamed.shell_kind = "OPEN_SHELL";
  const auto faults = faults_of(misnamed);
  ASSERT_THAT(faults, SizeIs(1));
  EXPECT_FALSE(faults[0].breaks);
  EXPECT_EQ(faults[0].entity, 2);
}

TEST(RawTopology, NamesWhatIsNotInTheFile) {
  std::string text = Tetrahedron().text();
  const auto drop = [&text](const std::string& begin) {
    const std::size_t at = text.find(begin);
    ASSERT_NE(at, std::string::npos);
    text.erase(at, text.find(';', at) + 1 - at);
  };
  drop("#12=");
  drop("#36=");
  const Part21 file(text);
  const RawTopology topology(file);
  ASSERT_FALSE(topology.faults().empty());
  EXPECT_EQ(topology.faults()[0].entity, 12);
  EXPECT_THAT(topology.faults()[0].what, HasSubstr("isn't in the file"));
}

TEST(RawTopology, EndsOnShellsThatContainThemselves) {
  const std::string text =
      "ISO-10303-21;HEADER;ENDSEC;DATA;#1=BREP_WITH_VOIDS('',#2,(#3));#2=CLOSED_SHELL('',(#4));"
      "#3=ORIENTED_CLOSED_SHELL('',*,#3,.T.);#4=ORIENTED_FACE('',*,#4,.T.);ENDSEC;END-ISO-10303-21;";
  const Part21 file(text);
  EXPECT_FALSE(RawTopology(file).faults().empty());
}

}  // namespace
}  // namespace lamella::step
