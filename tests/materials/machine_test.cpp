#include "materials/machine.h"

#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;

Machine shipped(const char* name) { return read_machine(test::datasets_dir() / "machines" / name); }

TEST(Machine, ResolutionInDotsPerInchBecomesAPitch) {
  const Machine machine = shipped("material_jetting.xml");
  EXPECT_EQ(machine.technology, Technology::material_jetting);
  EXPECT_DOUBLE_EQ(machine.pitch.x(), 25.4 / 600.0);
  EXPECT_DOUBLE_EQ(machine.pitch.y(), 25.4 / 300.0);
  EXPECT_DOUBLE_EQ(machine.layer_default, 0.027);
  EXPECT_DOUBLE_EQ(machine.shrink.x(), 0.0015);
  EXPECT_DOUBLE_EQ(machine.scale().x(), 1.0 / 0.9985);
}

TEST(Machine, ToolsHoldWhatTheirGlobsMatchAndAllWithoutAny) {
  const Machine machine = shipped("multi_nozzle.xml");
  EXPECT_TRUE(machine.can_hold(ToolId{2}, "Steel S2"));
  EXPECT_FALSE(machine.can_hold(ToolId{1}, "Steel S2"));
  EXPECT_TRUE(machine.can_hold(ToolId{1}, "TPE Thermolast K"));
  EXPECT_TRUE(machine.can_hold(ToolId{0}, "Steel S2"));
}

TEST(Machine, AChangeIsThatOfTheMatrixElseOfTheToolItLeadsTo) {
  const Machine machine = shipped("multi_nozzle.xml");
  EXPECT_DOUBLE_EQ(machine.change(ToolId{2}, ToolId{3}).time, 8.0);
  EXPECT_DOUBLE_EQ(machine.change(ToolId{2}, ToolId{0}).purge, 12.0);
  EXPECT_DOUBLE_EQ(machine.change(ToolId{0}, ToolId{1}).time, 20.0);
  EXPECT_DOUBLE_EQ(machine.change(ToolId{0}, ToolId{1}).purge, 40.0);
  EXPECT_DOUBLE_EQ(machine.change(ToolId{4}, ToolId{4}).time, 0.0);
}

TEST(Machine, TheFirstSettingsThatMatchCount) {
  const Machine machine = shipped("multi_vat.xml");
  EXPECT_DOUBLE_EQ(machine.settings_of("TPE Thermolast K").exposure, 5.0);
  EXPECT_DOUBLE_EQ(machine.settings_of("Brass").exposure, 2.5);
  EXPECT_DOUBLE_EQ(machine.settings_of("Brass").first_exposure, 30.0);
}

TEST(Machine, LayerHeightsAreWithinTheRangeAndOnTheStep) {
  const Machine vat = shipped("multi_vat.xml");
  EXPECT_EQ(layer_height_fault(vat, 0.1), "");
  EXPECT_EQ(layer_height_fault(vat, 0.025 + 0.05), "");
  EXPECT_THAT(layer_height_fault(vat, 0.06), HasSubstr("multiple of 0.025 mm"));
  EXPECT_THAT(layer_height_fault(vat, 0.2), HasSubstr("0.025 to 0.1 mm"));
  EXPECT_THAT(layer_height_fault(vat, std::nan("")), HasSubstr("0.025 to 0.1 mm"));
  EXPECT_EQ(layer_height_fault(shipped("multi_nozzle.xml"), 0.1234), "");
}

TEST(Machine, ToolsHaveTheirOwnLayersWithinTheMachines) {
  const Machine machine = read_machine(test::source_dir() / "schemas/valid/machine/every_attribute.xml");
  EXPECT_DOUBLE_EQ(machine.layers_of(ToolId{0}).lo, 0.1);
  EXPECT_DOUBLE_EQ(machine.layers_of(ToolId{0}).hi, 0.3);
  EXPECT_DOUBLE_EQ(machine.layers_of(ToolId{1}).lo, 0.15);
  EXPECT_DOUBLE_EQ(machine.layers_of(ToolId{1}).hi, 0.25);
  const Machine nozzles = shipped("multi_nozzle.xml");
  EXPECT_DOUBLE_EQ(nozzles.layers_of(ToolId{0}).lo, 0.1);
  EXPECT_DOUBLE_EQ(nozzles.layers_of(ToolId{2}).lo, 0.05);
  EXPECT_TRUE(takes_height({0.1, 0.2}, 0.1 - 4e-7));
  EXPECT_FALSE(takes_height({0.1, 0.2}, 0.2001));
}

TEST(Machine, TheAccelerationIsTheMaterialsElseTheToolsElseTheMachines) {
  Machine machine;
  machine.tools.push_back({"left", {}, 60.0, 200.0});
  machine.tools.push_back({"right", {}, 30.0, 150.0});
  const MaterialSettings plain;
  EXPECT_EQ(machine.depositing(ToolId{0}, plain), (RampedMotion{60.0}));
  EXPECT_TRUE(std::isinf(machine.traveling(ToolId{0}).acceleration));
  machine.acceleration = 3000.0;
  EXPECT_EQ(machine.depositing(ToolId{1}, plain), (RampedMotion{30.0, 3000.0}));
  EXPECT_EQ(machine.traveling(ToolId{1}), (RampedMotion{150.0, 3000.0}));
  machine.tools[ToolId{1}].acceleration = 2000.0;
  EXPECT_EQ(machine.depositing(ToolId{1}, plain), (RampedMotion{30.0, 2000.0}));
  EXPECT_EQ(machine.traveling(ToolId{1}), (RampedMotion{150.0, 2000.0}));
  machine.travel_acceleration = 5000.0;
  EXPECT_EQ(machine.traveling(ToolId{1}), (RampedMotion{150.0, 5000.0}));
  machine.tools[ToolId{1}].travel_acceleration = 4000.0;
  EXPECT_EQ(machine.traveling(ToolId{1}), (RampedMotion{150.0, 4000.0}));
  EXPECT_EQ(machine.traveling(ToolId{0}), (RampedMotion{200.0, 5000.0}));
  MaterialSettings soft;
  soft.speed = 20.0;
  soft.acceleration = 500.0;
  EXPECT_EQ(machine.depositing(ToolId{1}, soft), (RampedMotion{20.0, 500.0}));
}

TEST(Machine, ReadsAccelerations) {
  EXPECT_EQ(shipped("multi_nozzle.xml").depositing(ToolId{1}, {}).acceleration, 1000.0);
  EXPECT_EQ(shipped("multi_nozzle.xml").traveling(ToolId{1}).acceleration, 5000.0);
  EXPECT_EQ(shipped("multi_powder.xml").traveling(ToolId{0}).acceleration, 1e7);
  const Machine machine = read_machine(test::source_dir() / "schemas/valid/machine/every_attribute.xml");
  EXPECT_EQ(machine.acceleration, 3000.0);
  EXPECT_EQ(machine.travel_acceleration, 5000.0);
  EXPECT_EQ(machine.tools[ToolId{0}].acceleration, std::nullopt);
  EXPECT_EQ(machine.tools[ToolId{1}].acceleration, 2000.0);
  EXPECT_EQ(machine.tools[ToolId{1}].travel_acceleration, 4000.0);
  EXPECT_EQ(machine.settings[0].acceleration, 1000.0);
  EXPECT_EQ(machine.settings[1].acceleration, std::nullopt);
}

/// s over half the length from rest, in small steps of time.
double stepped_half(const RampedMotion& motion, double half) {
  constexpr double kStep = 1e-6;
  double speed = 0.0;
  double way = 0.0;
  for (double time = 0.0;; time += kStep) {
    const double next = std::min(motion.speed, speed + motion.acceleration * kStep);
    const double part = 0.5 * (speed + next) * kStep;
    if (way + part >= half) return time + kStep * (half - way) / part;
    way += part;
    speed = next;
  }
}

TEST(RampedMotion, TakesAsLongAsSmallStepsOfTimeDo) {
  for (const RampedMotion& motion :
       {RampedMotion{60.0, 3000.0}, RampedMotion{250.0, 1000.0}, RampedMotion{30.0, 50000.0}}) {
    // 1.2 mm, 62.5 mm and 0.018 mm are needed to reach the speed and lose it again.
    for (const double length : {1e-4, 0.01, 0.018, 0.5, 1.2, 2.0, 62.5, 70.0}) {
      EXPECT_NEAR(motion.time(length), 2.0 * stepped_half(motion, 0.5 * length), 3e-6) << length;
    }
    EXPECT_EQ(motion.time(0.0), 0.0);
  }
  EXPECT_DOUBLE_EQ((RampedMotion{50.0}).time(7.0), 7.0 / 50.0);
  EXPECT_EQ((RampedMotion{50.0}).time(0.0), 0.0);
}

/// What only the reader sees, and what its message must say.
struct Slip {
  const char* was;
  const char* becomes;
  const char* mentions;
};

class MachineSlip : public ::testing::TestWithParam<Slip> {};

TEST_P(MachineSlip, IsAnInputErrorWithLineAndHint) {
  std::ifstream stream(test::source_dir() / "schemas/valid/machine/every_attribute.xml");
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::string was = GetParam().was;
  ASSERT_NE(text.find(was), std::string::npos);
  text.replace(text.find(was), was.size(), GetParam().becomes);
  const test::TemporaryFolder folder;
  std::ofstream(folder / "m.xml") << text;
  try {
    (void)read_machine(folder / "m.xml");
    FAIL() << "accepted: " << GetParam().becomes;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(GetParam().mentions));
    EXPECT_THAT(error.where(), ::testing::ContainsRegex("m\\.xml:[0-9]+$"));
    EXPECT_NE(error.hint(), "");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Machine, MachineSlip,
    ::testing::Values(Slip{"price=\"48\" ", "", "go together"}, Slip{"dpi_y", "pitch_y", "pitches or resolutions"},
                      Slip{"<raster dpi_x=\"300\" dpi_y=\"150\"/>", "<raster/>", "pitches or resolutions"},
                      Slip{"min=\"0.1\" max=\"0.3\"", "min=\"0.3\" max=\"0.1\"", "less than min"},
                      Slip{"default=\"0.2\"", "default=\"0.22\"", "default height"},
                      Slip{"turn=\"0.1\"", "swath=\"1\"", "only material jetting"},
                      Slip{"technology=\"extrusion\"", "technology=\"material-jetting\"", "needs a swath"},
                      Slip{"technology=\"extrusion\"", "technology=\"powder-bed\"", "for extrusion"},
                      Slip{"layer_max=\"0.2\"", "layer_max=\"0.05\"", "more than layer_max"},
                      Slip{"layer_min=\"0.15\"", "layer_min=\"0.3\"", "more than layer_max"},
                      Slip{"layer_min=\"0.15\" layer_max=\"0.25\"", "layer_min=\"0.4\"", "aren't the machine's"},
                      Slip{"acceleration=\"3000\" ", "", "without the machine's own"},
                      Slip{" acceleration=\"3000\" travel_acceleration=\"5e3\"", "", "without the machine's own"},
                      Slip{"to=\"right\"", "to=\"left\"", "same tool"}, Slip{"P[LA]*", "P[LA*", "can't be used"}));

TEST(Machine, CutOffAnywhereIsAnInputError) {
  std::ifstream stream(test::source_dir() / "schemas/valid/machine/every_attribute.xml");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const test::TemporaryFolder folder;
  for (std::size_t size = 0; size + 12 < text.size(); size += 7) {
    std::ofstream(folder / "cut.xml") << text.substr(0, size);
    EXPECT_THROW((void)read_machine(folder / "cut.xml"), InputError) << size;
  }
}

std::string sample(const char* name) {
  std::ifstream stream(test::source_dir() / "schemas/valid/machine" / name);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void expect_refusal(std::string text, const std::string& was, const std::string& becomes, const char* mentions) {
  ASSERT_NE(text.find(was), std::string::npos);
  text.replace(text.find(was), was.size(), becomes);
  const test::TemporaryFolder folder;
  std::ofstream(folder / "m.xml") << text;
  try {
    (void)read_machine(folder / "m.xml");
    FAIL() << "accepted: " << becomes;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(mentions));
  }
}

TEST(Machine, OnlyWhatMovesIsAccelerated) {
  expect_refusal(sample("vat.xml"), "<deposition ", "<deposition acceleration=\"100\" ", "moves nothing");
  expect_refusal(sample("jetting.xml"), "<deposition ", "<deposition acceleration=\"100\" travel_acceleration=\"9\" ",
                 "no travels");
}

TEST(Machine, AVatNeedsAnExposureForEveryMaterial) {
  const test::TemporaryFolder folder;
  std::ifstream stream(test::source_dir() / "schemas/valid/machine/vat.xml");
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  text.replace(text.find(" exposure=\"2.5\""), 15, "");
  std::ofstream(folder / "vat.xml") << text;
  EXPECT_THROW((void)read_machine(folder / "vat.xml"), InputError);
}

}  // namespace
}  // namespace lamella
