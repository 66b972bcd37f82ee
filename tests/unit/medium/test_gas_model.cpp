// Gas models by ecCKD files that the tests make: each dependence on the mole fraction against its closed form.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "../app/temporary_folder.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/optics/planck.hpp"
#include "ecckd_example.hpp"

namespace cloudbow {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using namespace ecckd_example;

constexpr double gravity = 9.80665, air_molar_mass = 28.970e-3;

std::unique_ptr<GasModel> model_of(const Recipe& recipe = {}) {
  const TemporaryFolder folder;
  return read_gas_model(make_file(folder / "model.nc", recipe));
}

double air_of(double p1, double p2) { return std::abs(p2 - p1) / (gravity * air_molar_mass); }

/// One layer at 1e4 Pa of air at 230 K with these mole fractions of h2o, o3, ch4.
GasModel::LayerOptics one_layer(const GasModel& model, std::array<double, 3> x, double kelvin = 230,
                                double pressure = 1e4) {
  const std::array<double, 2> edges{0.5 * pressure, 1.5 * pressure};
  const std::vector<std::vector<double>> fraction{{x[0]}, {x[1]}, {x[2]}};
  return model.optics(edges, std::array<double, 1>{kelvin}, fraction);
}

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string error_of(const Recipe& recipe) {
  return error_of([&] { model_of(recipe); });
}

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

// -- The air between heights ------------------------------------------------------------------------------------------

Atmosphere small_air() {
  Atmosphere air;
  air.height_m = {0, 5000, 10000};
  air.pressure_pa = {1e5, 5e4, 2e4};
  air.temperature_k = {280, 250, 220};
  air.mole_fraction = {{"h2o", {1e-2, 1e-3, 1e-4}}, {"o3", {1e-8, 1e-7, 1e-6}}, {"ch4", {2e-6, 2e-6, 2e-6}}};
  return air;
}

TEST(GasOptics, OfLayersBetweenHeights) {
  const auto model = model_of();
  const Atmosphere air = small_air();
  const std::array<double, 3> edges{0, 4000, 7000};
  const auto optics = gas_optics(*model, air, edges);
  const double p1 = air.pressure_at(4000), p2 = air.pressure_at(7000), mean = (p1 + p2) / 2;
  // Of the second layer, whose mean pressure lies above 5000 m; pressure falls exponentially there.
  const double height = 5000 + 5000 * std::log(5e4 / mean) / std::log(2.5), share = (height - 5000) / 5000;
  ASSERT_GT(share, 0);
  const double kelvin = (air.temperature_at(4000) * p1 + air.temperature_at(7000) * p2) / (p1 + p2);
  const std::vector<std::vector<double>> fraction{
      {1e-3 + share * (1e-4 - 1e-3)}, {1e-7 + share * (1e-6 - 1e-7)}, {2e-6}};
  const auto expected = model->optics(std::array{p1, p2}, std::array{kelvin}, fraction);
  for (std::size_t g = 0; g < points; ++g) EXPECT_NEAR(optics.absorption[g][1] / expected.absorption[g][0], 1, 1e-12);
}

TEST(GasOptics, GoesOnBeyondTheProfile) {
  const auto model = model_of();
  const Atmosphere air = small_air();
  const std::array<double, 2> edges{12000, 15000};
  const double p1 = air.pressure_at(12000), p2 = air.pressure_at(15000);
  const auto expected =
      model->optics(std::array{p1, p2}, std::array{220.}, std::vector<std::vector<double>>{{1e-4}, {1e-6}, {2e-6}});
  EXPECT_NEAR(gas_optics(*model, air, edges).absorption[0][0] / expected.absorption[0][0], 1, 1e-12);
}

TEST(GasOptics, NamesAllGasesThatTheAirLacks) {
  const auto model = model_of();
  Atmosphere air = small_air();
  air.mole_fraction.erase("o3");
  air.mole_fraction.erase("ch4");
  const std::array<double, 2> edges{0, 1000};
  EXPECT_THAT(error_of([&] { gas_optics(*model, air, edges); }),
              AllOf(HasSubstr("lacks gases of the gas model: o3, ch4"), HasSubstr("found h2o"),
                    HasSubstr("allowed all of h2o, o3, ch4"), HasSubstr("one mole fraction")));
}

// -- Wrong files ------------------------------------------------------------------------------------------------------

TEST(GasModelFile, OfAnotherKind) {
  const TemporaryFolder folder;
  const auto path = folder / "other.nc";
  NetcdfBuilder other(path);
  other.dimension("x", 1);
  other.variable("rain", {"x"}, "mm", {1});
  other.close();
  EXPECT_THAT(error_of([&] { read_gas_model(path); }),
              AllOf(HasSubstr("other.nc: no gas model (found netCDF with the variables rain, allowed an ecCKD"),
                    HasSubstr("ecRad's data folder")));
  const auto text = folder.write("text.nc", "no model\n");
  EXPECT_THAT(
      error_of([&] { read_gas_model(text); }),
      AllOf(HasSubstr("text.nc: no gas model (found neither netCDF nor HDF5"), HasSubstr("ecRad's data folder")));
  EXPECT_THAT(error_of([&] { read_gas_model("missing.nc"); }),
              HasSubstr("missing.nc: can't be read (found no such file"));
}

TEST(GasModelFile, WithWrongContent) {
  // (Clang takes no braces with names within a macro.)
  const auto expect = [](const Recipe& file, const std::string& part) { EXPECT_THAT(error_of(file), HasSubstr(part)); };
  expect({.constituents = ""}, "no gas model");
  expect({.leave_out = "planck_function"}, "no gas model");
  expect({.leave_out = "o3_molar_absorption_coeff"},
         "'o3_molar_absorption_coeff': no such variable (found none, allowed "
         "o3_molar_absorption_coeff(temperature, pressure, g_point))");
  expect({.constituents = "composite co2"}, "'co2_conc_dependence_code': no such variable");
  expect({.constituents = "composite o3 o3"}, "a gas twice (found o3");
  expect({.pressure = {1e5, 1e4, 1e3}}, "'pressure': uneven");
  expect({.pressure = {1e3, 2e3, 1e5}}, "'pressure': uneven");
  expect({.pressure = {0, 1e4, 1e5}}, "'pressure': out of range (found 0");
  expect({.pressure = {1e5}}, "'pressure': length out of range (found 1");
  expect({.ch4_code = 4}, "'ch4_conc_dependence_code': out of range (found 4");
  expect({.ch4_code = 1.5}, "'ch4_conc_dependence_code': not a code (found 1.5");
  expect({.ch4_code = 2}, "'ch4_mole_fraction': no such variable");
  expect({.fraction = {1, 1, 1, 1}}, "'gpoint_fraction': not the fractions of a g-point");
  expect({.second_band = 2}, "'band_number': out of range (found 2");
  expect({.second_band = 0}, "'band_number': a band without g-points (found none in band 1");
  expect({.second_band = .5}, "'band_number': not a number of a band (found 0.5");
  expect({.leave_out = "wavenumber2_band", .second_band = 1}, "'wavenumber2_band': no such variable");
  expect({.least_absorption = -100}, "'o3_molar_absorption_coeff': out of range");
  expect({.least_absorption = std::nan("")}, "'o3_molar_absorption_coeff': out of range");
}

}  // namespace
}  // namespace cloudbow
