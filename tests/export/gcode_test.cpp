#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "core/error.h"
#include "export/gcode_sink.h"
#include "slicing/plan/statistics_sink.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"
#include "tests/support/read_gcode.h"

namespace lamella {
namespace {

using test::GcodeFile;
using test::GcodeMove;
using ::testing::HasSubstr;

Machine machine_with(GcodeFlavor flavor, bool relative, bool serpentine) {
  Machine machine = read_machine(test::datasets_dir() / "machines/multi_nozzle.xml");
  machine.gcode->flavor = flavor;
  machine.gcode->relative_extrusion = relative;
  machine.gcode->serpentine = serpentine;
  return machine;
}

/// Random tracks of three materials on hatch rows that turn from layer to layer.
struct Hatched {
  BuildInfo info;
  std::vector<Layer> layers;

  explicit Hatched(const Vec3& origin) {
    Grid grid;
    grid.origin = origin;
    grid.pitch = Vec3(0.5, 0.5, 0.2);
    grid.size = {60, 40, 6};
    info = test::make_build(grid, {"TPE soft", "PA hard", "Steel; \"E9\"\nT7"});
    info.plan.hatch = HatchLattice{0.4, 0.3, 0.5};
    for (BuildSolid& solid : info.solids) {
      solid.bounds = Box3(origin, Vec3(origin + Vec3(30.0, 20.0, 1.2)));
    }
    std::mt19937 random(3);
    for (std::int64_t k = 0; k < grid.size[2]; ++k) layers.push_back(fill(k, random));
  }

  /// A third of the rows' voxels a track, the rest void; hatch rows within the box.
  Layer fill(std::int64_t k, std::mt19937& random) const {
    const Grid& grid = info.plan.grid;
    Layer layer = test::layer_of_labels(info, k, [&](std::int64_t i, std::int64_t j, std::int64_t) {
      return static_cast<int>((i / 20 + j / 20 + k) % 4) - 1;
    });
    layer.hatch.emplace();
    layer.hatch->spacing = info.plan.hatch->spacing;
    layer.hatch->angle = info.plan.hatch->angle + info.plan.hatch->rotation * static_cast<double>(k);
    const HatchAxes axes = hatch_axes(*info.plan.hatch, static_cast<std::size_t>(k));
    const Vec2 middle = grid.origin.head<2>() + Vec2(15.0, 10.0);
    layer.hatch->first_row = static_cast<std::int64_t>(std::floor(middle.dot(axes.across) / 0.4)) - 8;
    for (int row = 0; row < 16; ++row) {
      double x = middle.dot(axes.along) - 8.0;
      for (int piece = 0; piece < 6; ++piece) {
        const double end = x + 0.05 + static_cast<double>(random() % 1000) * 2e-3;
        const std::size_t material = random() % 4;
        if (material < 3) layer.hatch->rows.segments.push_back({x, end, MaterialId{material}, SolidId{material}});
        x = end;
      }
      test::end_row(layer.hatch->rows);
    }
    return layer;
  }

  [[nodiscard]] BuildPlan plan(const Machine& machine) const {
    StatisticsSink sink(machine);
    test::feed(sink, info, layers);
    return make_plan(sink.info(), sink.layers(), machine);
  }

  [[nodiscard]] std::string text(const Machine& machine) const {
    const test::TemporaryFolder folder;
    const auto sink = make_gcode_sink(folder / "f.gcode", {plan(machine), machine});
    test::feed(*sink, info, layers);
    std::ifstream stream(folder / "f.gcode");
    return {std::istreambuf_iterator<char>(stream), {}};
  }
};

/// What the machine should do: the segments, those of one material that touch made one.
struct Track {
  Vec2 a;
  Vec2 b;
  std::size_t material;
  int layer;
};

std::vector<Track> expected_tracks(const Hatched& build, const Vec2& offset) {
  std::vector<Track> tracks;
  for (const Layer& layer : build.layers) {
    const double t = layer.hatch->angle;
    for (std::size_t r = 0; r < layer.hatch->rows.rows(); ++r) {
      const double v = (static_cast<double>(layer.hatch->first_row + static_cast<std::int64_t>(r)) + 0.5) * 0.4;
      const auto point = [&](double u) -> Vec2 {
        return Vec2(u * std::cos(t) - v * std::sin(t), u * std::sin(t) + v * std::cos(t)) + offset;
      };
      const Segment* last = nullptr;
      for (const Segment& segment : layer.hatch->rows.row(r)) {
        if (last != nullptr && last->x_end == segment.x_begin && last->material == segment.material) {
          tracks.back().b = point(segment.x_end);
        } else {
          tracks.push_back(
              {point(segment.x_begin), point(segment.x_end), segment.material.value(), static_cast<int>(layer.index)});
        }
        last = &segment;
      }
    }
  }
  return tracks;
}

struct GcodeCase {
  GcodeFlavor flavor;
  bool relative;
  bool serpentine;
};

class Gcode : public ::testing::TestWithParam<GcodeCase> {
 protected:
  Machine machine_ = machine_with(GetParam().flavor, GetParam().relative, GetParam().serpentine);
  Hatched build_{Vec3(100.0, 50.0, 0.0)};  // lies within the volume
};

TEST_P(Gcode, ExtrudesEverySegmentFromEndToEndAndNothingElse) {
  const GcodeFile file = test::GcodeReader().read(build_.text(machine_));
  std::vector<Track> expected = expected_tracks(build_, Vec2::Zero());
  ASSERT_GT(expected.size(), 200U);
  std::size_t found = 0;
  const double filament_area = kPi / 4.0 * 1.75 * 1.75;
  for (const GcodeMove& move : file.moves) {
    if (!move.moves() || move.filament <= 0.0) {
      EXPECT_TRUE(move.filament == 0.0 || !move.moves()) << "drawing back while moving";
      continue;
    }
    const Vec2 from = move.from.head<2>();
    const Vec2 to = move.to.head<2>();
    const auto track = std::find_if(expected.begin(), expected.end(), [&](const Track& one) {
      const bool forth = (one.a - from).norm() < 2e-4 && (one.b - to).norm() < 2e-4;
      const bool back = (one.b - from).norm() < 2e-4 && (one.a - to).norm() < 2e-4;
      return one.layer == move.layer && (forth || (back && GetParam().serpentine));
    });
    ASSERT_NE(track, expected.end()) << from.transpose() << " to " << to.transpose();
    const std::string& name = build_.info.materials[MaterialId{track->material}].name;
    EXPECT_EQ(move.material.substr(0, 5), name.substr(0, 5));
    const double flow = machine_.settings_of(name).flow;
    EXPECT_NEAR(move.filament, (track->b - track->a).norm() * 0.4 * 0.2 * flow / filament_area, 1.1e-5);
    EXPECT_DOUBLE_EQ(move.to.z(), build_.layers[static_cast<std::size_t>(move.layer)].z_top);
    expected.erase(track);
    ++found;
  }
  EXPECT_TRUE(expected.empty()) << expected.size() << " segments weren't extruded";
  EXPECT_GT(found, 200U);
}

TEST_P(Gcode, LengthsToolsAndFilamentAreThePlans) {
  const GcodeFile file = test::GcodeReader().read(build_.text(machine_));
  const BuildPlan plan = build_.plan(machine_);
  std::map<int, double> length;
  std::map<int, double> filament;
  std::map<int, std::size_t> tracks;
  for (const GcodeMove& move : file.moves) {
    filament[move.tool] += move.filament;
    if (!move.moves() || move.filament <= 0.0) continue;
    length[move.tool] += (move.to - move.from).norm();
    ++tracks[move.tool];
  }
  for (const PlanMaterial& material : plan.materials) {
    ASSERT_EQ(material.tools.size(), 1U);
    const int tool = static_cast<int>(material.tools.front().value());
    EXPECT_NEAR(length[tool], material.length, 1e-4 * static_cast<double>(tracks[tool])) << material.name;
    const MaterialSettings settings = machine_.settings_of(material.name);
    const double pushed = (material.length * 0.4 * 0.2 * settings.flow + material.purge) / (kPi / 4.0 * 1.75 * 1.75);
    EXPECT_NEAR(filament[tool], pushed - settings.retraction, 1e-3) << material.name;
    EXPECT_DOUBLE_EQ(file.temperature.at(tool), settings.temperature);
  }
  std::vector<std::pair<int, int>> order;
  for (const PlanLayer& layer : plan.layers) {
    for (const PlanStep& step : layer.steps) {
      const int tool = static_cast<int>(step.tool.value());
      if (order.empty() || order.back().second != tool) order.emplace_back(static_cast<int>(layer.index), tool);
    }
  }
  EXPECT_EQ(file.tools, order);
  EXPECT_EQ(file.tools.size(), plan.tool_changes + 1);
}

TEST_P(Gcode, StaysWithinTheMachineWhereverThePartLies) {
  const Hatched far(Vec3(-1000.0, 40.0, -7.0));
  const GcodeFile file = test::GcodeReader().read(far.text(machine_));
  Box3 box;
  for (const GcodeMove& move : file.moves) box.extend(move.to);
  EXPECT_TRUE((box.min().array() >= 0.0).all()) << box.min().transpose();
  EXPECT_TRUE((box.max().array() <= machine_.volume.array()).all()) << box.max().transpose();
  EXPECT_NEAR(box.max().z(), 1.2, 1e-9);
}

/// s from rest to rest, in this test's own words.
double ramped(double length, double speed, double acceleration) {
  const double ramp = speed / acceleration;  // s to reach the speed, and again to lose it
  const double over_ramps = ramp * speed;
  return over_ramps <= length ? 2.0 * ramp + (length - over_ramps) / speed : std::sqrt(4.0 * length / acceleration);
}

TEST_P(Gcode, AcceleratesAsTheMachineStatesAndTakesThePlansTime) {
  for (MaterialSettings& settings : machine_.settings) {
    if (settings.match == "Steel*") settings.acceleration = 700.0;
  }
  const GcodeFile file = test::GcodeReader().read(build_.text(machine_));
  const BuildPlan plan = build_.plan(machine_);
  // The profile's tools; steel and soft filament have a speed of their own.
  const std::vector<double> tool_speeds{40.0, 30.0, 80.0, 80.0, 80.0, 80.0};
  std::map<std::string, double> time;
  std::string material;
  int layer = -1;
  std::set<double> told;
  for (const GcodeMove& move : file.moves) {
    if (!move.moves() || (move.is_travel && (move.to - Vec3(5.0, 350.0, move.to.z())).norm() < 1e-9)) continue;
    const bool is_soft = move.material.starts_with("TPE");
    const bool is_steel = move.material.starts_with("Steel");
    // The profile: 3000 and 5000 mm/s^2, the soft head 1000 on its tracks.
    const double of_tracks = is_steel ? 700.0 : move.tool == 1 ? 1000.0 : 3000.0;
    EXPECT_DOUBLE_EQ(move.acceleration, move.is_travel ? 5000.0 : of_tracks);
    told.insert(move.acceleration);
    // On the way to the first track of a material on a layer the plan knows nothing.
    const bool is_first = move.material != material || move.layer != layer;
    material = move.material;
    layer = move.layer;
    if (is_first && move.is_travel) continue;
    const double of_material = is_steel ? 40.0 : is_soft ? 30.0 : tool_speeds.at(static_cast<std::size_t>(move.tool));
    const double speed = move.is_travel ? 250.0 : of_material;
    time[material] += ramped((move.to - move.from).norm(), speed, move.acceleration);
  }
  EXPECT_GE(told.size(), 3U);
  // A macro that changes tools may have set others.
  const std::string text = build_.text(machine_);
  const std::string command = GetParam().flavor == GcodeFlavor::klipper ? "\nSET_VELOCITY_LIMIT" : "\nM204";
  std::size_t commands = 0;
  for (std::size_t at = text.find(command); at != std::string::npos; at = text.find(command, at + 1)) ++commands;
  EXPECT_GE(commands, file.tools.size());
  for (const PlanMaterial& one : plan.materials) {
    const auto found = std::find_if(time.begin(), time.end(),
                                    [&](const auto& pair) { return pair.first.substr(0, 5) == one.name.substr(0, 5); });
    ASSERT_NE(found, time.end());
    EXPECT_NEAR(found->second, one.time, 1e-3 * one.time) << one.name;
  }
}

TEST(GcodeText, SaysNothingOfAccelerationsThatAreNotStated) {
  Machine machine = machine_with(GcodeFlavor::marlin, true, true);
  machine.acceleration.reset();
  machine.travel_acceleration.reset();
  for (MachineTool& tool : machine.tools) tool.acceleration.reset();
  const Hatched build(Vec3(100.0, 50.0, 0.0));
  EXPECT_EQ(build.text(machine).find("M204"), std::string::npos);
  machine.acceleration = 1234567.5;
  EXPECT_THAT(build.text(machine), HasSubstr("\nM204 P1234567.5 T1234567.5\n"));
  machine.gcode->flavor = GcodeFlavor::klipper;
  EXPECT_THAT(build.text(machine), HasSubstr("\nSET_VELOCITY_LIMIT ACCEL=1234567.5\n"));
}

INSTANTIATE_TEST_SUITE_P(Flavors, Gcode,
                         ::testing::Values(GcodeCase{GcodeFlavor::marlin, true, true},
                                           GcodeCase{GcodeFlavor::marlin, false, false},
                                           GcodeCase{GcodeFlavor::reprapfirmware, true, false},
                                           GcodeCase{GcodeFlavor::reprapfirmware, false, true},
                                           GcodeCase{GcodeFlavor::klipper, true, true},
                                           GcodeCase{GcodeFlavor::klipper, false, false}));

TEST(GcodeText, NamesCannotBecomeCommands) {
  const Hatched build(Vec3(100.0, 50.0, 0.0));
  const std::string text = build.text(machine_with(GcodeFlavor::marlin, true, true));
  EXPECT_EQ(text.find("\nT7"), std::string::npos);
  EXPECT_THAT(text, HasSubstr("Steel_ _E9__T7"));
  for (const char c : text) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~'));
}

TEST(GcodeText, StopsForAReload) {
  Machine machine = machine_with(GcodeFlavor::klipper, true, true);
  machine.tools = {};
  machine.tools.push_back({"only", {}, 50.0, 200.0, 5.0});
  machine.changes.clear();
  Hatched build(Vec3(100.0, 50.0, 0.0));
  for (Layer& layer : build.layers) {
    for (Segment& segment : layer.raster.segments) segment.material = MaterialId{layer.index / 3};
    for (Segment& segment : layer.hatch->rows.segments) segment.material = MaterialId{layer.index / 3};
  }
  const GcodeFile file = test::GcodeReader().read(build.text(machine));
  EXPECT_EQ(file.pauses.size(), 1U);
  EXPECT_EQ(file.tools.size(), 1U);
}

TEST(GcodeText, RefusesAPlanThatLeavesSegmentsOut) {
  const Machine machine = machine_with(GcodeFlavor::marlin, true, true);
  const Hatched build(Vec3(100.0, 50.0, 0.0));
  BuildPlan plan = build.plan(machine);
  plan.layers[3].steps.pop_back();
  const test::TemporaryFolder folder;
  {
    const auto sink = make_gcode_sink(folder / "f.gcode", {plan, machine});
    EXPECT_THROW(test::feed(*sink, build.info, build.layers), InputError);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// Number behind `key` in the header.
double header_number(const std::string& text, const std::string& key) {
  const std::size_t at = text.find("; " + key + " ");
  return at == std::string::npos ? -1.0 : std::stod(text.substr(at + key.size() + 3));
}

TEST(GcodeText, HeaderOfARangeTellsWhatIsInTheFile) {
  const Machine machine = machine_with(GcodeFlavor::marlin, true, true);
  Hatched build(Vec3(100.0, 50.0, 0.0));
  const BuildPlan plan = build.plan(machine);
  build.info.given = {2, 4};
  const test::TemporaryFolder folder;
  const auto sink = make_gcode_sink(folder / "f.gcode", {plan, machine});
  sink->begin(build.info);
  for (int k = 2; k < 4; ++k) sink->write(build.layers[static_cast<std::size_t>(k)]);
  sink->finish({});
  std::ifstream stream(folder / "f.gcode");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_DOUBLE_EQ(header_number(text, "layers:"), 2.0);
  EXPECT_THAT(text, HasSubstr("; of the build's 6 layers only 2 to 3: "));
  EXPECT_THAT(text, HasSubstr("; WARNING: begins at Z0.4000, on top of layer 1: "));
  const double before = plan.layers[2].steps.front().change_time;
  EXPECT_NEAR(header_number(text, "time:"), plan.layers[2].time + plan.layers[3].time - before, 0.051);
  // The rest as the moves have it.
  const GcodeFile file = test::GcodeReader().read(text);
  EXPECT_DOUBLE_EQ(header_number(text, "tool changes:"), static_cast<double>(file.tools.size()) - 1.0);
  double length = 0.0;
  for (const GcodeMove& move : file.moves) {
    if (move.moves() && move.filament > 0.0) length += (move.to - move.from).norm();
  }
  double told = 0.0;
  for (std::size_t at = text.find(", tracks "); at != std::string::npos; at = text.find(", tracks ", at + 1)) {
    told += std::stod(text.substr(at + 9));
  }
  EXPECT_NEAR(told, length, 0.01 * length / 100.0);
  EXPECT_LT(told, 0.5 * (plan.materials[0].length + plan.materials[1].length + plan.materials[2].length));
}

TEST(GcodeText, HeaderOfAWholeBuildHasNoRange) {
  const Machine machine = machine_with(GcodeFlavor::marlin, true, true);
  const Hatched build(Vec3(100.0, 50.0, 0.0));
  const std::string text = build.text(machine);
  EXPECT_DOUBLE_EQ(header_number(text, "layers:"), 6.0);
  EXPECT_DOUBLE_EQ(header_number(text, "tool changes:"), static_cast<double>(build.plan(machine).tool_changes));
  EXPECT_EQ(text.find("WARNING"), std::string::npos);
  EXPECT_EQ(text.find("of the build's"), std::string::npos);
}

template <class Failure>
void expect_refused(const Hatched& build, const BuildPlan& plan, const Machine& machine, const char* mentions) {
  const test::TemporaryFolder folder;
  const auto sink = make_gcode_sink(folder / "f.gcode", {plan, machine});
  try {
    sink->begin(build.info);
    FAIL() << "accepted, though " << mentions;
  } catch (const Failure& error) {
    EXPECT_THAT(std::string(error.what()) + error.hint(), HasSubstr(mentions));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(GcodeText, RefusesWhatDoesNotBelongTogether) {
  const Machine machine = machine_with(GcodeFlavor::marlin, true, true);
  Hatched build(Vec3(100.0, 50.0, 0.0));
  const BuildPlan plan = build.plan(machine);
  Machine other = machine;
  other.name = "other";
  expect_refused<InputError>(build, plan, other, "another machine");
  BuildPlan shorter = plan;
  shorter.layers.pop_back();
  expect_refused<InputError>(build, shorter, machine, "number of layers");
  BuildPlan renamed = plan;
  renamed.materials[0].name = "x";
  expect_refused<InputError>(build, renamed, machine, "materials");
  Machine small = machine;
  small.volume = Vec3(10, 10, 10);
  expect_refused<InputError>(build, plan, small, "larger");
  Machine without = machine;
  without.gcode.reset();
  expect_refused<InputError>(build, plan, without, "no G-code");
  build.info.plan.hatch.reset();
  expect_refused<UsageError>(build, plan, machine, "--hatch-spacing");
}

}  // namespace
}  // namespace lamella
