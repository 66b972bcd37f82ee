// Light by bands. Truth: sums over the points of a band, and means over the columns.
#include <gtest/gtest.h>

#include "../medium/fake_gas_model.hpp"
#include "cloudbow/results/band_profile.hpp"

namespace cloudbow {
namespace {

Solution two_columns(double flux) {
  Solution solution;
  solution.box.nx = 2;
  solution.box.z_edge_m = {0, 100, 200};
  solution.profile_upwelling_flux = {flux, 2 * flux, 3 * flux};
  solution.profile_downwelling_diffuse_flux = {4 * flux, 5 * flux, 6 * flux};
  solution.profile_direct_flux = {7 * flux, 8 * flux, 9 * flux};
  solution.absorbed_power = {static_cast<float>(flux), static_cast<float>(3 * flux), 0, static_cast<float>(2 * flux)};
  return solution;
}

TEST(BandProfile, IsTheSumOfItsPointsAndTheMeanOfTheColumns) {
  BandProfile band;
  add_to_band(two_columns(1), band);
  add_to_band(two_columns(10), band);
  EXPECT_EQ(band.upwelling_flux, (std::vector<double>{11, 22, 33}));
  EXPECT_EQ(band.downwelling_diffuse_flux, (std::vector<double>{44, 55, 66}));
  EXPECT_EQ(band.direct_flux, (std::vector<double>{77, 88, 99}));
  EXPECT_EQ(band.absorbed_power, (std::vector<double>{22, 11}));
}

TEST(BandProfile, HasNoPowerIfSolutionsHaveNone) {
  Solution solution = two_columns(1);
  solution.absorbed_power.clear();
  BandProfile band;
  add_to_band(solution, band);
  EXPECT_TRUE(band.absorbed_power.empty());
}

TEST(BandProfile, IsOneOfTheWholeSpectrumForAModelWithoutBands) {
  const FakeGasModel model(GasModel::Light::longwave, {{100, 200}, {200, 500}, {}}, {{1, 0}, {0, 1}});
  const std::vector<BandProfile> profiles = band_profiles(model);
  ASSERT_EQ(profiles.size(), 1U);
  EXPECT_EQ(profiles[0].wavenumber_cm1, (std::array<double, 2>{100, 500}));
  EXPECT_TRUE(profiles[0].upwelling_flux.empty());
}

}  // namespace
}  // namespace cloudbow
