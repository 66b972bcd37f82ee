// Averages of bulk optics. Truth: averages by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/bulk_optics.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;
using Values = std::vector<double>;

constexpr double rounding = 1e-13;

BulkTable two_by_two() {
  BulkTable table;
  table.wavenumber_cm1 = {1000, 2000};
  table.effective_radius_um = {5, 10};
  table.value = {{{.3, 1, .8}, {.15, .5, .9}}, {{.1, .5, .4}, {.05, 0, 0}}};
  return table;
}

TEST(BulkOptics, AConstantTableIsItsOwnAverage) {
  BulkTable table = two_by_two();
  table.value[1] = table.value[0];
  for (const Values& weight : {Values{1, 1, 1}, Values{0, 3, 0}, Values{5, 0, 1}}) {
    const auto average = average_over(table, Values{1100, 1300, 1800}, weight);
    EXPECT_NEAR(average[0].extinction_m2_per_g, .3, rounding);
    EXPECT_NEAR(average[0].single_scattering_albedo, 1, rounding);
    EXPECT_LE(average[0].single_scattering_albedo, 1);
    EXPECT_NEAR(average[0].asymmetry, .8, rounding);
    EXPECT_NEAR(average[1].single_scattering_albedo, .5, rounding);
    EXPECT_NEAR(average[1].asymmetry, .9, rounding);
  }
}

TEST(BulkOptics, AlbedoIsWeightedByExtinctionAndAsymmetryByScattering) {
  // A constant weight over all: the mean of both rows.
  const auto average = average_over(two_by_two(), Values{1000, 2000}, Values{7, 7});
  EXPECT_NEAR(average[0].extinction_m2_per_g, .2, rounding);
  EXPECT_NEAR(average[0].single_scattering_albedo, (.3 + .05) / .4, rounding);
  const double g = (.3 * .8 + .05 * .4) / (.3 + .05);
  EXPECT_NEAR(average[0].asymmetry, g, asymmetry_step / 2);
  EXPECT_NEAR(average[0].asymmetry / asymmetry_step, std::round(g / asymmetry_step), 1e-9);
  EXPECT_NEAR(average[1].single_scattering_albedo, .075 / .2, rounding);
  EXPECT_NEAR(average[1].asymmetry, .9, rounding);  // all that scatters has it
}

TEST(BulkOptics, LinearExtinctionUnderALinearWeight) {
  // k = .5 - nu / 5000, w = nu - 1000 over 1000 to 2000: <k> is k at 1000 + 2/3 1000.
  const auto average = average_over(two_by_two(), Values{1000, 2000}, Values{0, 1000});
  EXPECT_NEAR(average[0].extinction_m2_per_g, .3 - .2 * 2 / 3, rounding);
}

TEST(BulkOptics, TwoIntervalsAreTheirMiddlesWeighted) {
  const auto average = average_over(two_by_two(), Values{1100, 1200, 1200, 1700, 1700, 1900}, Values{4, 4, 0, 0, 1, 1});
  // 400 at 1150 cm-1 and 200 at 1800 cm-1.
  EXPECT_NEAR(average[0].extinction_m2_per_g, (2 * (.3 - .2 * .15) + (.3 - .2 * .8)) / 3, rounding);
}

TEST(BulkOptics, WithoutScatteringOrExtinctionNothingIsNaN) {
  BulkTable table = two_by_two();
  for (auto& row : table.value) row = {{.2, 0, .7}, {0, .5, .5}};
  const auto average = average_over(table, Values{1000, 2000}, Values{1, 1});
  EXPECT_NEAR(average[0].extinction_m2_per_g, .2, rounding);
  EXPECT_EQ(average[0].single_scattering_albedo, 0);
  EXPECT_EQ(average[0].asymmetry, 0);
  EXPECT_EQ(average[1].extinction_m2_per_g, 0);
  EXPECT_EQ(average[1].single_scattering_albedo, 0);
  EXPECT_EQ(average[1].asymmetry, 0);
}

TEST(BulkOptics, EndValuesGoOnForASmallPartOfTheWeight) {
  // 50 of 1050 cm-1 lie beyond.
  const auto average = average_over(two_by_two(), Values{950, 2000}, Values{1, 1});
  EXPECT_NEAR(average[0].extinction_m2_per_g, (.3 * 50 + .2 * 1000) / 1050, rounding);
  EXPECT_THAT(
      [] {
        average_over(two_by_two(), Values{500, 2000}, Values{1, 1});
      },
      ThrowsMessage<InputError>(HasSubstr(
          "too short for 500 to 2000 cm-1 (found 1000 to 2000, 33 % beyond, allowed 10); take another table")));
  BulkTable named = two_by_two();
  named.name = "ice.nc";
  EXPECT_THAT(
      [&] {
        average_over(named, Values{2500, 3000}, Values{1, 1});
      },
      ThrowsMessage<InputError>(HasSubstr("ice.nc: too short")));
}

TEST(BulkOptics, RowsMixByMass) {
  const BulkTable table = two_by_two();
  const std::vector<BulkOptics> rows{{.3, 1, .8}, {.15, .5, .9}};
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}}) {
    const BulkOptics same = at_radius(table, rows, table.effective_radius_um[n]);
    EXPECT_NEAR(same.extinction_m2_per_g, rows[n].extinction_m2_per_g, rounding);
    EXPECT_NEAR(same.single_scattering_albedo, rows[n].single_scattering_albedo, rounding);
    EXPECT_NEAR(same.asymmetry, rows[n].asymmetry, rounding);
  }
  // 1/r_e = .15 is halfway; k = 1.5/r_e in both rows, and so between them.
  const BulkOptics half = at_radius(table, rows, 1 / .15);
  EXPECT_NEAR(half.extinction_m2_per_g, 1.5 * .15, rounding);
  EXPECT_NEAR(half.single_scattering_albedo, (.3 + .075) / .45, rounding);
  EXPECT_NEAR(half.asymmetry, (.3 * .8 + .075 * .9) / .375, asymmetry_step / 2);
  for (const double radius : {4.9, 10.1}) {
    EXPECT_THAT([&] { at_radius(table, rows, radius); }, ThrowsMessage<InputError>(HasSubstr("allowed 5 to 10 um")));
  }
}

TEST(BulkOptics, ATableOfOneRowHasOneRadius) {
  BulkTable table = two_by_two();
  table.effective_radius_um = {5};
  for (auto& row : table.value) row.resize(1);
  check_bulk_table(table);
  const auto average = average_over(table, Values{1000, 2000}, Values{1, 1});
  EXPECT_NEAR(at_radius(table, average, 5).extinction_m2_per_g, .2, rounding);
  EXPECT_THROW(at_radius(table, average, 5.1), InputError);
}

TEST(BulkOptics, ChecksTables) {
  const auto expect_refused = [](auto&& change, const char* text) {
    BulkTable table = two_by_two();
    table.name = "t";
    check_bulk_table(table);
    change(table);
    EXPECT_THAT([&] { check_bulk_table(table); }, ThrowsMessage<InputError>(HasSubstr(text)));
  };
  expect_refused([](BulkTable& t) { t.wavenumber_cm1 = {2000, 1000}; }, "t: wavenumber does not ascend");
  expect_refused([](BulkTable& t) { t.wavenumber_cm1[0] = 0; }, "wavenumber out of range");
  expect_refused([](BulkTable& t) { t.wavenumber_cm1.clear(); }, "no wavenumber");
  expect_refused([](BulkTable& t) { t.effective_radius_um = {5, 5}; }, "effective radius does not ascend");
  expect_refused([](BulkTable& t) { t.effective_radius_um = {5, 1e7}; }, "look at its units");
  expect_refused([](BulkTable& t) { t.value.pop_back(); }, "rows of another number");
  expect_refused([](BulkTable& t) { t.value[1].pop_back(); }, "a row of another length");
  expect_refused([](BulkTable& t) { t.value[1][0].extinction_m2_per_g = 0; }, "mass extinction out of range");
  expect_refused([](BulkTable& t) { t.value[1][1].single_scattering_albedo = 1.1; },
                 "found 1.1 at 2000 cm-1 and 10 um, allowed 0 to 1");
  expect_refused([](BulkTable& t) { t.value[0][0].asymmetry = -1.01; }, "asymmetry parameter out of range");
}

}  // namespace
}  // namespace cloudbow
