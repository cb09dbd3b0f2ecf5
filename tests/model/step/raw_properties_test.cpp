#include "model/step/raw_properties.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lamella::step {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string file_of(const std::string& data) {
  return "ISO-10303-21;HEADER;FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));ENDSEC;DATA;" + data + "ENDSEC;END-ISO-10303-21;";
}

std::string with_unit(const std::string& units) {
  return file_of(
      "#1=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#9,#2))REPRESENTATION_CONTEXT('',"
      "''));#9=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));"
      "#8=ADVANCED_BREP_SHAPE_REPRESENTATION('',(),#1);" +
      units);
}

LengthUnit only_unit(const std::string& units) {
  const std::string text = with_unit(units);
  const auto found = length_units(Part21(text));
  EXPECT_THAT(found, SizeIs(1)) << units;
  return found.empty() ? LengthUnit{} : found.front();
}

TEST(RawProperties, KnowsTheApplicationProtocols) {
  EXPECT_EQ(application_protocol("CONFIG_CONTROL_DESIGN"), "AP203");
  EXPECT_EQ(application_protocol("automotive_design { 1 0 10303 214 1 1 1 1 }"), "AP214");
  EXPECT_EQ(application_protocol("AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {1 0}"), "AP242");
  EXPECT_EQ(application_protocol("MY_SCHEMA"), "MY_SCHEMA");
}

TEST(RawProperties, ReadsEveryLengthUnit) {
  const auto si = [](const std::string& prefix) {
    return only_unit("#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(" + prefix + ",.METRE.));");
  };
  EXPECT_EQ(si(".MILLI.").in_mm, 1.0);
  EXPECT_EQ(si(".MILLI.").name, "millimetre");
  EXPECT_EQ(si("$").in_mm, 1000.0);
  EXPECT_EQ(si(".CENTI.").in_mm, 10.0);
  EXPECT_DOUBLE_EQ(si(".MICRO.").in_mm, 1e-3);
  const LengthUnit inch = only_unit(
      "#2=(CONVERSION_BASED_UNIT('INCH',#3)LENGTH_UNIT()NAMED_UNIT(#5));#3=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE("
      "25.4),#4);#4=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));");
  EXPECT_DOUBLE_EQ(inch.in_mm, 25.4);
  EXPECT_EQ(inch.name, "INCH");
  const LengthUnit foot = only_unit(
      "#2=(CONVERSION_BASED_UNIT('FOOT',#3)LENGTH_UNIT()NAMED_UNIT(#5));#3=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE("
      "12.),#6);#6=(CONVERSION_BASED_UNIT('INCH',#7)LENGTH_UNIT()NAMED_UNIT(#5));#7=LENGTH_MEASURE_WITH_UNIT("
      "LENGTH_MEASURE(2.54),#4);#4=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));");
  EXPECT_DOUBLE_EQ(foot.in_mm, 304.8);
}

TEST(RawProperties, RefusesUnitsThatContradictThemselves) {
  const std::string onto_itself = with_unit(
      "#2=(CONVERSION_BASED_UNIT('X',#3)LENGTH_UNIT()NAMED_UNIT(#5));#3=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.),#2)"
      ";");
  EXPECT_THAT(length_units(Part21(onto_itself)), IsEmpty());
  const std::string zero = with_unit(
      "#2=(CONVERSION_BASED_UNIT('X',#3)LENGTH_UNIT()NAMED_UNIT(#5));#3=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.),#4)"
      ";"
      "#4=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));");
  EXPECT_THAT(length_units(Part21(zero)), IsEmpty());
}

/// A part whose material has this density in this unit.
std::string with_density(const std::string& value, const std::string& unit) {
  return file_of(
      "#1=PRODUCT_DEFINITION('','',$,$);#2=PROPERTY_DEFINITION('material property','material name',#1);"
      "#3=PROPERTY_DEFINITION_REPRESENTATION(#2,#4);#4=REPRESENTATION('material name',(#5),$);"
      "#5=DESCRIPTIVE_REPRESENTATION_ITEM('Steel','1.4404');"
      "#6=PROPERTY_DEFINITION('material property','density',#1);"
      "#7=PROPERTY_DEFINITION_REPRESENTATION(#6,#8);#8=REPRESENTATION('density',(#9),$);"
      "#9=MEASURE_REPRESENTATION_ITEM('density measure',POSITIVE_RATIO_MEASURE(" +
      value + "),#10);" + unit +
      "#21=(MASS_UNIT()NAMED_UNIT(*)SI_UNIT($,.GRAM.));#22=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));"
      "#23=(MASS_UNIT()NAMED_UNIT(*)SI_UNIT(.KILO.,.GRAM.));#24=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));"
      "#25=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));");
}

std::optional<double> density(const std::string& text, std::size_t findings = 0) {
  std::vector<Finding> found;
  const auto table = materials(Part21(text), found);
  EXPECT_THAT(found, SizeIs(findings));
  EXPECT_EQ(table.at(1).name, "Steel");
  return table.at(1).density;
}

std::string derived(int mass, const char* mass_exponent, int length, const char* length_exponent) {
  return "#10=DERIVED_UNIT((#11,#12));#11=DERIVED_UNIT_ELEMENT(#" + std::to_string(mass) + "," + mass_exponent +
         ");#12=DERIVED_UNIT_ELEMENT(#" + std::to_string(length) + "," + length_exponent + ");";
}

TEST(RawProperties, ReadsDensitiesInGramsPerCubicCentimetre) {
  EXPECT_DOUBLE_EQ(*density(with_density("7.9", derived(21, "1.", 22, "-3."))), 7.9);
  EXPECT_DOUBLE_EQ(*density(with_density("7900.", derived(23, "1.", 24, "-3."))), 7.9);
  EXPECT_NEAR(*density(with_density("7.9E-06", derived(23, "1.", 25, "-3."))), 7.9, 1e-12);
  EXPECT_DOUBLE_EQ(*density(with_density("7.9", derived(21, "3.", 22, "2."))), 7.9) << "as OpenCASCADE writes it";
  EXPECT_DOUBLE_EQ(*density(with_density("7.9", "")), 7.9) << "without a unit";
}

TEST(RawProperties, LeavesOutAndNamesImplausibleDensities) {
  EXPECT_EQ(density(with_density("7.9", derived(21, "2.", 22, "-1.")), 1), std::nullopt);
  EXPECT_EQ(density(with_density("-7.9", derived(21, "1.", 22, "-3.")), 1), std::nullopt);
  EXPECT_EQ(density(with_density("235.", derived(21, "1.", 22, "-3.")), 1), std::nullopt);
}

}  // namespace
}  // namespace lamella::step
