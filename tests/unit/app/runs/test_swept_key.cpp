// Truth: the values that a list names, counted by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/runs/swept_key.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

std::vector<std::string> values(const std::string& list) { return parse_swept_key("a.b=" + list).values; }

TEST(SweptKey, ReadsLists) {
  EXPECT_EQ(parse_swept_key("sun.zenith_deg=0,30").key, "sun.zenith_deg");
  EXPECT_TRUE(parse_swept_key("sun.zenith_deg=0,30").is_list);
  EXPECT_THAT(values("0,30, 60.5"), ElementsAre("0", "30", "60.5"));
  EXPECT_THAT(values(R"("a, b",c,'d,"e')"), ElementsAre(R"("a, b")", "c", R"('d,"e')"));
  EXPECT_THAT(values(R"("a\",b",c)"), ElementsAre(R"("a\",b")", "c"));
  EXPECT_THAT(values("[1, 2],[3,4]"), ElementsAre("[1, 2]", "[3,4]"));
  EXPECT_THAT(values("../a.vdb,C:b:c"), ElementsAre("../a.vdb", "C:b:c"));
}

TEST(SweptKey, ReadsRangesWithTheirDecimals) {
  EXPECT_THAT(values("0:85:30"), ElementsAre("0", "30", "60"));
  EXPECT_THAT(values("0:90:30"), ElementsAre("0", "30", "60", "90"));
  EXPECT_THAT(values("0:.3:0.1"), ElementsAre("0.0", "0.1", "0.2", "0.3"));
  EXPECT_THAT(values("60:0:-30"), ElementsAre("60", "30", "0"));
  EXPECT_THAT(values("-1:1:1"), ElementsAre("-1", "0", "1"));
  EXPECT_THAT(values("0,10:30:10,85"), ElementsAre("0", "10", "20", "30", "85"));
  EXPECT_THAT(values("1e-3:3e-3:1e-3"), testing::SizeIs(3));
  EXPECT_THAT(values("5:5:1"), ElementsAre("5"));
}

TEST(SweptKey, OneValueIsNoList) {
  EXPECT_FALSE(parse_swept_key("solver.accuracy=draft").is_list);
  EXPECT_FALSE(parse_swept_key("title=it's").is_list);
  EXPECT_FALSE(parse_swept_key("output.fields=[\"fluxes\", \"actinic\"]").is_list);
  EXPECT_TRUE(parse_swept_key("sun.zenith_deg=30:30:1").is_list);
}

TEST(SweptKey, RefusesListsWithoutSense) {
  for (const auto& [list, words] :
       std::vector<std::pair<std::string, std::string>>{{"", "an empty value"},
                                                        {"1,,2", "an empty value"},
                                                        {"1,", "an empty value"},
                                                        {"0:60", "a range has FIRST:LAST:STEP"},
                                                        {"0:1:2:3", "FIRST:LAST:STEP"},
                                                        {"0 30  60", "allowed 0,30,60"},
                                                        {"0:10:0", "STEP"},
                                                        {"0:10:-1", "STEP"},
                                                        {"0:1:1e-9", "too long"},
                                                        {"0:1:1e-300", "found 1e+300 values"},
                                                        {"1,2,1.0", "found 1.0"},
                                                        {"a,\"a\"", "twice"},
                                                        {"[0,30", "without its partner"},
                                                        {"0],30", "without its partner"},
                                                        {"{0,30", "without its partner"},
                                                        {"\"0,30", "without its partner"}}) {
    EXPECT_THAT([&list = list] { values(list); }, ThrowsMessage<InputError>(HasSubstr(words))) << list;
  }
  EXPECT_THAT([] { parse_swept_key("zenith"); }, ThrowsMessage<InputError>(HasSubstr("KEY=VALUE")));
  EXPECT_THAT([] { parse_swept_key("=1"); }, ThrowsMessage<InputError>(HasSubstr("KEY=VALUE")));
  EXPECT_THAT([] { check_values({"a", {}, true}); }, ThrowsMessage<InputError>(HasSubstr("empty list")));
}

// NaN is refused by the scene.
TEST(SweptKey, NoNumberIsTwiceThereBesideNan) {
  EXPECT_THAT(values("0,nan,1,nan"), ElementsAre("0", "nan", "1", "nan"));
  EXPECT_THAT([] { values("nan,1,2,1"); }, ThrowsMessage<InputError>(HasSubstr("found 1")));
}

TEST(SweptKey, CoordinatesAreNumbersOrTexts) {
  EXPECT_THAT(coordinate_values(parse_swept_key("a=0,30.5")).numbers, ElementsAre(0, 30.5));
  EXPECT_THAT(coordinate_values(parse_swept_key("a=0,30.5")).texts, IsEmpty());
  EXPECT_THAT(coordinate_values(parse_swept_key("a=b,\"c d\"")).texts, ElementsAre("b", "c d"));
  EXPECT_THAT(coordinate_values(parse_swept_key("a=b,1")).texts, ElementsAre("b", "1"));
  EXPECT_THAT(coordinate_values(parse_swept_key("a=true,false")).texts, ElementsAre("true", "false"));
}

std::vector<std::string> names(const std::vector<std::string>& keys) {
  std::vector<SweptKey> swept;
  for (const std::string& key : keys) swept.push_back({key, {"1", "2"}, true});
  return dimension_names(swept);
}

TEST(SweptKey, DimensionsAreNamedAfterTheLastPart) {
  EXPECT_THAT(names({"sun.zenith_deg", "surface.albedo"}), ElementsAre("zenith_deg", "albedo"));
  EXPECT_THAT(names({"sun.zenith_deg", "radiance.0.zenith_deg"}),
              ElementsAre("sun_zenith_deg", "radiance_0_zenith_deg"));
  // A variable of results has this name.
  EXPECT_THAT(names({"layer.0.optical_depth"}), ElementsAre("layer_0_optical_depth"));
  // Groups of results have these.
  EXPECT_THAT(names({"output.error_estimate"}), ElementsAre("output_error_estimate"));
  EXPECT_THAT(names({"cloud", "solver", "thermal"}),
              ElementsAre("cloud_of_scene", "solver_of_scene", "thermal_of_scene"));
}

// HDF5 takes / for the way to another group.
TEST(SweptKey, NamesOfDimensionsDifferAndStayInTheirGroup) {
  EXPECT_THAT(names({"phase_function.a/b.asymmetry_parameter", "phase_function.c.asymmetry_parameter"}),
              ElementsAre("phase_function_a_b_asymmetry_parameter", "phase_function_c_asymmetry_parameter"));
  EXPECT_THAT(names({"p.a/b.g", "p.a_b.g"}), ElementsAre("p_a_b_g", "p_a_b_g_2"));
}

TEST(SweptKey, UnitsStandInTheName) {
  EXPECT_EQ(units_of_key("sun.zenith_deg"), "degree");
  EXPECT_EQ(units_of_key("sun.irradiance_w_m2"), "W m-2");
  EXPECT_EQ(units_of_key("cloud.effective_radius_um"), "um");
  EXPECT_EQ(units_of_key("layer.0.top_m"), "m");
  EXPECT_EQ(units_of_key("surface.temperature_k"), "K");
  EXPECT_EQ(units_of_key("surface.albedo"), "1");
}

}  // namespace
}  // namespace cloudbow
