// Tables of droplets: mixtures between rows, and the conditions on a table. Truth: the closed form of mixing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/droplet_table.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

DropletTable two_rows() { return {0.67, {5, 10}, {0.4, 0.1}, {0.5, 1}, {{1, 0.4, 0.1, 0.008}, {1, 0.2, 0.05, 0.002}}}; }

std::string message(const DropletTable& table) {
  try {
    check_droplet_table(table);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(DropletTable, RowsAreKeptAsTheyAre) {
  const DropletTable table = two_rows();
  EXPECT_EQ(message(table), "no error");
  const DropletOptics lower = droplet_optics(table, 5), upper = droplet_optics(table, 10);
  EXPECT_EQ(lower.extinction_m2_per_g, 0.4);
  EXPECT_EQ(lower.single_scattering_albedo, 0.5);
  EXPECT_EQ(lower.phase_function.moment(3), 0.008);
  EXPECT_EQ(upper.extinction_m2_per_g, 0.1);
  EXPECT_EQ(upper.phase_function.moment(1), 0.2);
}

// Masses m1 = m2 = 1/2 of radii 5 and 10: surface (m/r) adds up, r_e = 1 / (1/2 / 5 + 1/2 / 10) = 6.667. Extinction
// (0.4 + 0.1)/2, scattering (0.2 + 0.1)/2, the phase functions 2 : 1.
TEST(DropletTable, BetweenRowsStandsTheirMixture) {
  const DropletTable table = two_rows();
  const double radius = 1 / (0.5 / 5 + 0.5 / 10);
  const DropletMixture mixture = mixture_for(table, radius);
  EXPECT_EQ(mixture.lower, 0u);
  EXPECT_NEAR(mixture.upper_share, 0.5, 1e-15);
  const DropletOptics optics = droplet_optics(table, radius);
  EXPECT_NEAR(optics.extinction_m2_per_g, 0.25, 1e-15);
  EXPECT_NEAR(optics.single_scattering_albedo, 0.15 / 0.25, 1e-15);
  EXPECT_NEAR(optics.phase_function.moment(1), (2 * 0.4 + 0.2) / 3, 1e-15);
  EXPECT_NEAR(optics.phase_function.moment(3), (2 * 0.008 + 0.002) / 3, 1e-15);
}

// The same mixture: scattering .2/2 of the lower row and .1/2 of the upper one.
TEST(DropletTable, ScatteringOfAMixtureAddsUp) {
  const MixedDroplets mixed = mix(two_rows(), {0, 0.5});
  EXPECT_NEAR(mixed.extinction_m2_per_g, 0.25, 1e-15);
  EXPECT_NEAR(mixed.scattering_m2_per_g, 0.15, 1e-15);
  EXPECT_NEAR(mixed.single_scattering_albedo(), 0.6, 1e-15);
  EXPECT_NEAR(mixed.upper_share_of_scattering(7), 1. / 3, 1e-15);
  DropletTable black = two_rows();
  black.single_scattering_albedo = {0, 0};
  EXPECT_EQ(mix(black, {0, 0.5}).upper_share_of_scattering(7), 7);
  EXPECT_EQ(mix(black, {1, 0}).extinction_m2_per_g, 0.1);  // the last row has no row above it
}

TEST(DropletTable, OutsideIsAnError) {
  EXPECT_THROW(mixture_for(two_rows(), 4.9), InputError);
  EXPECT_THROW(mixture_for(two_rows(), 10.1), InputError);
  EXPECT_NO_THROW(mixture_for(two_rows(), 10 * (1 + 5e-7)));  // stored as a float
  EXPECT_EQ(mixture_for({0, {7}, {0.2}, {1}, {{1, 0.8, 0.01}}}, 7).lower, 0u);
}

// Henyey and Greenstein's function of .9, cut after 64 moments: 129 x .9^63 = .17 is left of its terms. Half of that
// oscillates at 180 degrees, at which the function itself is .028.
TEST(DropletTable, RingingOfASeriesThatWasCutIsTold) {
  DropletTable table = two_rows();
  for (int l = 1; l < 64; ++l) {
    table.moments[1].resize(64);
    table.moments[1][l] = std::pow(0.9, l);
  }
  EXPECT_THAT(check_droplet_table(table), AllOf(HasSubstr("radius 10 um"), HasSubstr("-0.05"), HasSubstr("180")));
  EXPECT_EQ(check_droplet_table(two_rows()), "");
}

TEST(DropletTable, SaysWhatIsWrong) {
  DropletTable table = two_rows();
  table.extinction_m2_per_g[1] = 9.96920996838687e36;  // never written, as netCDF has it
  EXPECT_THAT(message(table),
              AllOf(HasSubstr("extinction at effective radius 10 um"), HasSubstr("up to 1000000 m2/g")));
  table = two_rows();
  for (const double wavelength : {std::nan(""), -0.67, HUGE_VAL}) {
    table.wavelength_um = wavelength;
    EXPECT_THAT(message(table), HasSubstr("wavelength out of range"));
  }
  table = two_rows();
  table.effective_radius_um = {10, 5};
  EXPECT_THAT(message(table), HasSubstr("do not ascend"));
  table.effective_radius_um = {5e-6, 1e-5};  // metres
  EXPECT_THAT(message(table), HasSubstr("found 5e-06 um, allowed 0.001 to 5000 um"));
  table.effective_radius_um = {4000, 6000};  // nanometres
  EXPECT_THAT(message(table), HasSubstr("found 6000 um"));
  table = two_rows();
  table.moments[1][0] = 0.9;
  EXPECT_THAT(message(table), HasSubstr("wrong norm"));
  table = two_rows();
  table.moments[1][1] = 2.4;
  EXPECT_THAT(message(table), HasSubstr("without the factor 2l+1"));
  table = two_rows();
  table.moments[0] = {1, 0.85, 0.79, 0.72, 0.65};  // the front of a peaked function
  EXPECT_THAT(message(table), HasSubstr("too few moments"));
  table.moments[0] = {1, 0.8, 0.6, 0.01};  // 1 + 2.4 mu + 3 P_2 + .07 P_3
  EXPECT_THAT(message(table), AllOf(HasSubstr("radius 5 um"), HasSubstr("negative (found -0.79"), HasSubstr("2l+1")));
  table = two_rows();
  table.single_scattering_albedo[0] = 1.1;
  EXPECT_THAT(message(table), HasSubstr("single-scattering albedo"));
  table = two_rows();
  table.extinction_m2_per_g[0] = 0;
  EXPECT_THAT(message(table), HasSubstr("extinction"));
  table = two_rows();
  table.moments.pop_back();
  EXPECT_THAT(message(table), HasSubstr("as many of each"));
}

}  // namespace
}  // namespace cloudbow
