// Optical depths and emission by the tables of an ecCKD file. Truth: tables that are linear, so that interpolation
// gives them exactly.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>

#include "../app/temporary_folder.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/optics/planck.hpp"
#include "ecckd_example.hpp"
#include "gas_test_tools.hpp"

namespace cloudbow {
namespace {

using ::testing::ElementsAre;

using namespace ecckd_example;

TEST(GasModel, NamesWhatItNeeds) {
  const auto longwave = model_of();
  EXPECT_EQ(longwave->light(), GasModel::Light::longwave);
  EXPECT_EQ(longwave->points(), 2);
  EXPECT_THAT(longwave->gases(), ElementsAre("h2o", "o3", "ch4"));
  EXPECT_TRUE(longwave->spectrum().solar.empty());
  EXPECT_EQ(longwave->solar_share(0), 0);
  const auto solar = model_of({.is_solar = true});
  EXPECT_EQ(solar->light(), GasModel::Light::solar);
  EXPECT_THAT(solar->spectrum().solar, ElementsAre(15, 25));
  EXPECT_EQ(solar->planck(0, 300), 0);
}

// Truth: the closed forms of the tables, which are linear in ln p, T and ln x; rounding only.
TEST(GasModel, DependsOnEachGasAsItsCodeSays) {
  const auto model = model_of();
  constexpr double pressure = 2e4, kelvin = 237;
  const double air = air_of(0.5 * pressure, 1.5 * pressure), level = std::log10(pressure / lowest_pressure);
  for (const double h2o : {2e-4, 5e-3}) {
    const double o3 = 3e-6, ch4 = 3e-6;
    const auto optics = one_layer(*model, {h2o, o3, ch4}, kelvin, pressure);
    const double look_up = 1 + std::log10(h2o / h2o_fraction[0]);
    for (std::size_t g = 0; g < points; ++g) {
      const double expected = air * coefficient(1e-6 + 10 * o3 + 5 * (ch4 - ch4_reference) + look_up * h2o, level,
                                                kelvin, static_cast<double>(g));
      EXPECT_NEAR(optics.absorption[g][0], expected, 1e-12 * expected);
    }
  }
}

TEST(GasModel, KeepsToTheEndsOfItsTables) {
  const auto model = model_of();
  const auto depth = [&](double h2o, double kelvin, double pressure) {
    return one_layer(*model, {h2o, 0, ch4_reference}, kelvin, pressure).absorption[0][0] /
           air_of(0.5 * pressure, 1.5 * pressure);
  };
  // The upper end of a table lies at index n - 1.0001: off by 1e-4 of a step, and less than that of the value.
  constexpr double end = 1e-4;
  const auto expected = [](double look_up, double h2o, double kelvin, double level) {
    return coefficient(1e-6 + look_up * h2o, level, kelvin, 0);
  };
  EXPECT_NEAR(depth(1e-6, 230, 1e4), expected(1, 1e-6, 230, 1), 1e-15);
  EXPECT_NEAR(depth(0.1, 230, 1e4), expected(3, 0.1, 230, 1), end);
  EXPECT_NEAR(depth(0, 230, 1e4), expected(0, 0, 230, 1), 1e-18);
  EXPECT_NEAR(depth(1e-3, 150, 1e4), expected(2, 1e-3, 210, 1), 1e-15);
  EXPECT_NEAR(depth(1e-3, 350, 1e4), expected(2, 1e-3, 250, 1), end * 1e-3);
  EXPECT_NEAR(depth(1e-3, 230, 10), expected(2, 1e-3, 230, 0), 1e-15);
  EXPECT_NEAR(depth(1e-3, 230, 1e6), expected(2, 1e-3, 230, 2), end * 1e-3);
}

TEST(GasModel, IsNeverNegative) {
  const auto model = model_of();
  EXPECT_EQ(one_layer(*model, {0, 0, 0}).absorption[0][0], 0);  // ch4 below its reference
}

TEST(GasModel, TakesLayersFromEitherEnd) {
  const auto model = model_of({.is_solar = true});
  const std::vector<std::vector<double>> rising{{1e-3, 2e-3}, {1e-6, 2e-6}, {0, 0}},
      falling{{2e-3, 1e-3}, {2e-6, 1e-6}, {0, 0}};
  const auto up = model->optics(std::array{9e4, 5e4, 1e4}, std::array{250., 220.}, rising);
  const auto down = model->optics(std::array{1e4, 5e4, 9e4}, std::array{220., 250.}, falling);
  for (std::size_t g = 0; g < points; ++g) {
    EXPECT_EQ(up.absorption[g][0], down.absorption[g][1]);
    EXPECT_EQ(up.absorption[g][1], down.absorption[g][0]);
    EXPECT_EQ(up.rayleigh[g][0], down.rayleigh[g][1]);
  }
}

TEST(GasModel, ScattersSunlight) {
  const auto model = model_of({.is_solar = true});
  const auto optics = one_layer(*model, {0, 0, 0});
  EXPECT_DOUBLE_EQ(optics.rayleigh[0][0], 1e-6 * air_of(5e3, 15e3));
  EXPECT_DOUBLE_EQ(optics.rayleigh[1][0], 2e-6 * air_of(5e3, 15e3));
  EXPECT_TRUE(one_layer(*model_of(), {0, 0, 0}).rayleigh.empty());
  EXPECT_DOUBLE_EQ(model->solar_share(0), 0.75);
  EXPECT_DOUBLE_EQ(model->solar_share(1), 0.25);
}

TEST(GasModel, EmitsByItsTable) {
  const auto model = model_of();
  EXPECT_NEAR(model->planck(0, 200) * std::numbers::pi, 1, 1e-12);
  EXPECT_NEAR(model->planck(0, 225) * std::numbers::pi, 2, 1e-12);
  EXPECT_NEAR(model->planck(1, 290) * std::numbers::pi, 8.2, 1e-12);
}

// Truth: Planck's law over the intervals, by the g-point's shares of them; it joins the table's ends.
TEST(GasModel, EmitsBeyondItsTableByPlancksLaw) {
  const auto model = model_of();
  const PlanckFunction first = PlanckFunction::over({1e4 / 700, 1e4 / 600}),
                       second = PlanckFunction::over({1e4 / 900, 1e4 / 700});
  const auto law = [&](double kelvin) {
    return model->share_of_interval(0, 0) * first(kelvin) + model->share_of_interval(0, 1) * second(kelvin);
  };
  for (const double kelvin : {300.001, 330., 1000.})
    EXPECT_NEAR(model->planck(0, kelvin) / model->planck(0, 300), law(kelvin) / law(300), 1e-12 * kelvin);
  for (const double kelvin : {199.999, 150., 20.})
    EXPECT_NEAR(model->planck(0, kelvin) / model->planck(0, 200), law(kelvin) / law(200), 1e-12);
  EXPECT_EQ(model->planck(0, 0), 0);
}

TEST(GasModel, SharesIntervals) {
  const auto model = model_of();
  EXPECT_NEAR(model->share_of_interval(0, 0), 0.25 * width_1 / 100, 1e-12);
  EXPECT_NEAR(model->share_of_interval(0, 1), 0.75 * width_1 / 200, 1e-12);
  EXPECT_NEAR(model->share_of_interval(1, 0), 0.5 * width_2 / 100, 1e-12);
  EXPECT_NEAR(model->share_of_interval(1, 1), 0.5 * width_2 / 200, 1e-12);
  EXPECT_THAT(model->spectrum().lower, ElementsAre(600, 700));
  EXPECT_THAT(model->spectrum().upper, ElementsAre(700, 900));
}

TEST(GasModel, WithoutBandsIsOne) {
  const GasModel::Bands bands = model_of()->bands();
  EXPECT_THAT(bands.lower, ElementsAre(600));
  EXPECT_THAT(bands.upper, ElementsAre(900));
  EXPECT_THAT(bands.of_point, ElementsAre(0, 0));
}

TEST(GasModel, HasTheBandsOfItsFile) {
  const GasModel::Bands bands = model_of({.second_band = 1})->bands();
  EXPECT_THAT(bands.lower, ElementsAre(600, 800));
  EXPECT_THAT(bands.upper, ElementsAre(800, 900));
  EXPECT_THAT(bands.of_point, ElementsAre(0, 1));
}

TEST(GasModel, HasASunForFilesWithoutSpectrum) {
  const auto model = model_of({.leave_out = "solar_spectral_irradiance", .is_solar = true});
  EXPECT_NEAR(model->spectrum().solar[0], PlanckFunction::over({1e4 / 700, 1e4 / 600})(5777), 1e-12);
}

}  // namespace
}  // namespace cloudbow
