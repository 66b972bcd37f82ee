// Mie tables for averages over spectra. Truth: tables with phase functions, Rayleigh's and large spheres' limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/mie_bulk.hpp"
#include "cloudbow/optics/mie_table.hpp"
#include "droplet_test_tools.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::SizeIs;
using Values = std::vector<double>;

TEST(MieBulk, AgreesWithTablesOfPhaseFunctions) {
  const Values radii{4, 10};
  for (const double wavelength : {.8, 3.7, 11.0, 80.0}) {
    const auto bulk = mie_bulk_optics(water(wavelength), radii, .01);
    MieTableOptions options;
    options.size_step = .05;
    const DropletTable table = make_mie_table(water(wavelength), radii, options);
    for (std::size_t r = 0; r < 2; ++r) {
      // The table takes a fifth of its step for these: the same sums.
      EXPECT_DOUBLE_EQ(bulk[r].extinction_m2_per_g, table.extinction_m2_per_g[r]) << wavelength;
      EXPECT_DOUBLE_EQ(bulk[r].single_scattering_albedo, table.single_scattering_albedo[r]) << wavelength;
      // Sums of efficiencies here, of intensities in steps of .05 there: narrow resonances.
      EXPECT_NEAR(bulk[r].asymmetry, table.moments[r][1], 5e-4) << wavelength;
    }
  }
}

TEST(MieBulk, CoarseStepsAreEnough) {
  // .26 %, 4e-4 and .002 are the largest differences of steps of 1 from .05, at 60 wavelengths and radii of 2 to 15 um.
  const Values radii{6};
  for (const double wavelength : {.4, 1.6, 10.0}) {
    const auto fine = mie_bulk_optics(water(wavelength), radii, .02),
               coarse = mie_bulk_optics(water(wavelength), radii, 1);
    EXPECT_NEAR(coarse[0].extinction_m2_per_g / fine[0].extinction_m2_per_g, 1, .003) << wavelength;
    EXPECT_NEAR(coarse[0].single_scattering_albedo, fine[0].single_scattering_albedo, 4e-4) << wavelength;
    EXPECT_NEAR(coarse[0].asymmetry, fine[0].asymmetry, .002) << wavelength;
  }
}

TEST(MieBulk, IsByWavenumberAndHasItsLimits) {
  const Values wavelengths{.3, 2, 900}, radii{5, 10};
  const BulkTable table = make_mie_bulk_table({}, wavelengths, radii);
  ASSERT_THAT(table.wavenumber_cm1, SizeIs(wavelengths.size()));
  EXPECT_DOUBLE_EQ(table.wavenumber_cm1.back(), 1e4 / .3);
  EXPECT_DOUBLE_EQ(table.wavenumber_cm1.front(), 1e4 / 900);
  // Q_ext of large spheres is 2 (1 + x^(-2/3)), van de Hulst's edge term, to a few per cent: k = 3 Q / (4 r_e).
  const double x = 2 * M_PI * 10 / .3;
  EXPECT_NEAR(table.value.back()[1].extinction_m2_per_g / (1.5 / 10 * (1 + std::pow(x, -2. / 3))), 1, .01);
  // Rayleigh absorption per volume has no size: 6 pi / lambda Im (m^2 - 1)/(m^2 + 2), at x of .03 to 1e-3 of itself.
  const auto m = refractive_index(Substance::water, 900);
  const double rayleigh = 6 * M_PI / 900 * ((m * m - 1.) / (m * m + 2.)).imag();
  const BulkOptics& small = table.value.front()[0];
  EXPECT_NEAR(small.extinction_m2_per_g * (1 - small.single_scattering_albedo) / rayleigh, 1, .02);
  EXPECT_NEAR(small.asymmetry, 0, .02);
}

TEST(MieBulk, HasTheDensityOfItsSubstance) {
  MieBulkRecipe ice;
  ice.substance = Substance::ice;
  // Of large spheres k is 1.5 / (rho r_e).
  const BulkTable of_ice = make_mie_bulk_table(ice, Values{.3}, Values{20});
  const BulkTable of_water = make_mie_bulk_table({}, Values{.3}, Values{20});
  EXPECT_NEAR(of_ice.value[0][0].extinction_m2_per_g * .917 / of_water.value[0][0].extinction_m2_per_g, 1, .01);
}

TEST(MieBulk, WavelengthsAreOfEqualRatios) {
  const Values band = mie_wavelengths(8, 80);
  ASSERT_THAT(band, SizeIs(61));
  EXPECT_DOUBLE_EQ(band.back(), 80);
  for (std::size_t n = 0; n < band.size(); ++n)
    EXPECT_DOUBLE_EQ(band[n], 8 * std::pow(10, static_cast<double>(n) / 60));
  const Values all = mie_wavelengths(.1, INFINITY);
  EXPECT_EQ(all.front(), shortest_index_wavelength);
  EXPECT_EQ(all.back(), longest_index_wavelength);
  // .544 decades of 24, .854 of 200, 2.301 of 60, rounded up.
  EXPECT_THAT(all, SizeIs(14 + 171 + 139 + 1));
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), std::less_equal<>()));
  EXPECT_THROW(mie_wavelengths(2000, 3000), InputError);
  EXPECT_THROW(mie_wavelengths(2, 1), InputError);
  EXPECT_THROW(make_mie_bulk_table({}, Values{}, Values{5}), InputError);
  EXPECT_THROW(make_mie_bulk_table({}, Values{1500}, Values{5}), InputError);
}

TEST(MieBulk, HasTheSameBitsFromTheCacheAndWithAnyThreads) {
  const fs::path folder = fs::temp_directory_path() / ("cloudbow_mie_bulk_" + std::to_string(getpid()));
  const Values wavelengths{1, 3, 12}, radii{5, 8};
  MieBulkOptions options;
  options.threads = 1;
  const BulkTable one = make_mie_bulk_table({}, wavelengths, radii, options);
  options.threads = 3;
  options.cache_directory = folder;
  const BulkTable made = make_mie_bulk_table({}, wavelengths, radii, options);
  ASSERT_FALSE(fs::is_empty(folder));
  const BulkTable cached = make_mie_bulk_table({}, wavelengths, radii, options);
  for (const BulkTable* other : {&made, &cached}) {
    for (std::size_t n = 0; n < 3; ++n) {
      for (std::size_t r = 0; r < 2; ++r) {
        EXPECT_EQ(other->value[n][r].extinction_m2_per_g, one.value[n][r].extinction_m2_per_g);
        EXPECT_EQ(other->value[n][r].single_scattering_albedo, one.value[n][r].single_scattering_albedo);
        EXPECT_EQ(other->value[n][r].asymmetry, one.value[n][r].asymmetry);
      }
    }
  }
  // Another recipe is another entry.
  MieBulkRecipe narrow;
  narrow.effective_variance = .05;
  EXPECT_NE(make_mie_bulk_table(narrow, wavelengths, radii, options).value[0][0].extinction_m2_per_g,
            one.value[0][0].extinction_m2_per_g);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace cloudbow
