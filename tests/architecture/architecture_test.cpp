#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>

#include "tests/architecture/include_rules.h"
#include "tests/support/paths.h"

namespace lamella::test {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string contents(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Architecture, EveryIncludePointsLeftAndThirdPartiesStayInTheirPlace) {
  const auto sources = layered_sources(source_dir());
  ASSERT_GT(sources.size(), 30u);
  for (const auto& source : sources) {
    for (const auto& violation : check_includes(source.string(), contents(source_dir() / source))) {
      ADD_FAILURE() << violation.file << " includes " << violation.header << ": " << violation.reason;
    }
  }
}

/// Names of the types that `text` defines in namespaces, as "lamella::step::Assembly".
std::vector<std::string> defined_types(const std::string& text) {
  static const std::regex kNamespace("^namespace ([A-Za-z_:]+) \\{$");
  static const std::regex kType("^(?:class|struct|enum class) ([A-Za-z0-9]+)\\b[^;]*$");
  std::vector<std::string> types;
  std::string scope;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kNamespace)) scope = match[1];
    if (std::regex_match(line, match, kType)) types.push_back(scope + "::" + match[1].str());
  }
  return types;
}

// Two types of one name in two libraries are one to the linker, which keeps either's functions for both.
TEST(Architecture, NoTwoHeadersDefineTheSameType) {
  std::map<std::string, std::string> home;
  for (const auto& source : layered_sources(source_dir())) {
    if (source.extension() != ".h") continue;
    for (const std::string& type : defined_types(contents(source_dir() / source))) {
      const auto [place, is_new] = home.emplace(type, source.string());
      EXPECT_TRUE(is_new) << type << " is defined in " << place->second << " and in " << source;
    }
  }
  EXPECT_THAT(home, ::testing::Contains(::testing::Key("lamella::Scene")));
}

TEST(Architecture, FindsAnArrowToTheRight) {
  EXPECT_THAT(check_includes("model/scene.h", "#include \"slicing/layer.h\"\n"), SizeIs(1));
  EXPECT_THAT(check_includes("core/xml.cpp", "  #  include \"model/scene.h\" // why\n"), SizeIs(1));
  EXPECT_THAT(check_includes("slicing/slicer.cpp", "#include \"model/scene.h\"\n"), IsEmpty());
}

TEST(Architecture, FindsAnIncludeThatSkipsTheFolder) {
  EXPECT_THAT(check_includes("model/trim.cpp", "#include \"trim.h\"\n"), SizeIs(1));
  EXPECT_THAT(check_includes("model/trim.cpp", "#include \"../core/ids.h\"\n"), SizeIs(1));
}

TEST(Architecture, FindsAThirdPartyOutsideItsPlace) {
  EXPECT_THAT(check_includes("slicing/slicer.cpp", "#include <gp_Pnt.hxx>\n"), SizeIs(1));
  EXPECT_THAT(check_includes("model/step/read_step.cpp", "#include <gp_Pnt.hxx>\n"), IsEmpty());
  EXPECT_THAT(check_includes("export/png_stack.h", "#include <png.h>\n"), SizeIs(1));
  EXPECT_THAT(check_includes("export/vdb/vdb_sink.h", "#include <openvdb/openvdb.h>\n"), SizeIs(1));
  EXPECT_THAT(check_includes("core/parallel.h", "#include <tbb/parallel_for.h>\n"), SizeIs(1));
}

TEST(Architecture, FindsAnUnknownThirdParty) {
  EXPECT_THAT(check_includes("model/mesh.cpp", "#include <CGAL/Surface_mesh.h>\n"), SizeIs(1));
  EXPECT_THAT(check_includes("model/mesh.cpp", "#include <vector>\n#include <unistd.h>\n"), IsEmpty());
}

}  // namespace
}  // namespace lamella::test
