// Spectral weights of g-points. Truth: a model of three intervals, by hand, and Stefan's law.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/spectral_weight.hpp"
#include "cloudbow/optics/bulk_optics.hpp"
#include "cloudbow/optics/planck.hpp"
#include "fake_gas_model.hpp"

namespace cloudbow {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

double integral_of(const SpectralWeight& w) {
  double sum = 0;
  for (std::size_t n = 1; n < w.weight.size(); ++n) {
    sum += (w.wavenumber_cm1[n] - w.wavenumber_cm1[n - 1]) * (w.weight[n] + w.weight[n - 1]) / 2;
  }
  return sum;
}

FakeGasModel solar() {
  return {GasModel::Light::solar,
          {.lower = {1000, 2000, 5000}, .upper = {2000, 5000, 6000}, .solar = {10, 60, 40}},
          {{1, .5, 0}, {0, .5, .25}, {0, 0, .75}, {0, 0, 0}}};
}

TEST(SpectralWeight, OfSunlightIsTheShareOfTheIntervals) {
  // 10 over 1000 cm-1, then half of 60 over 3000 cm-1.
  const SpectralWeight first = weight_of_point(solar(), 0);
  EXPECT_THAT(first.wavenumber_cm1, ElementsAre(1000, 2000, 2000, 5000));
  EXPECT_THAT(first.weight, ElementsAre(DoubleEq(.01), DoubleEq(.01), DoubleEq(.01), DoubleEq(.01)));
  const SpectralWeight second = weight_of_point(solar(), 1);
  EXPECT_THAT(second.wavenumber_cm1, ElementsAre(2000, 5000, 5000, 6000));
  EXPECT_THAT(second.weight, ElementsAre(DoubleEq(.01), DoubleEq(.01), DoubleEq(.01), DoubleEq(.01)));
  double sum = 0;
  for (int point = 0; point < 3; ++point) sum += integral_of(weight_of_point(solar(), point));
  EXPECT_NEAR(sum, 110, 1e-12);  // rounding
  EXPECT_THAT([] { weight_of_point(solar(), 3); }, ThrowsMessage<InputError>(HasSubstr("g-point 4 has no share")));
  EXPECT_THAT(wavelengths_of(solar()), ElementsAre(DoubleEq(1e4 / 6000), DoubleEq(10)));
}

TEST(SpectralWeight, OfLongwaveSumsToTheBlackBody) {
  // From 0 to 10000 cm-1 in steps of 10: Stefan's law at 288 K, but for 1e-16 beyond 1 um.
  GasModel::Spectrum spectrum;
  std::vector<std::vector<double>> share(2);
  for (int n = 0; n < 1000; ++n) {
    spectrum.lower.push_back(10 * n);
    spectrum.upper.push_back(10 * (n + 1));
    share[0].push_back(n % 3 == 0 ? .25 : 0);
    share[1].push_back(1 - share[0].back());
  }
  const FakeGasModel model(GasModel::Light::longwave, spectrum, share);
  constexpr double stefan_boltzmann = 5.670374419e-8;
  const SpectralWeight with_gaps = weight_of_point(model, 0), rest = weight_of_point(model, 1);
  EXPECT_NEAR(integral_of(with_gaps) + integral_of(rest),
              stefan_boltzmann * std::pow(weight_temperature_k, 4) / std::numbers::pi, 1e-8);  // digits of the constant
  double alone = 0;
  for (int n = 0; n < 1000; n += 3) {
    const double longest = n == 0 ? INFINITY : 1e4 / (10 * n);
    alone += .25 * PlanckFunction::over({1e4 / (10 * (n + 1)), longest}).radiance(weight_temperature_k);
  }
  EXPECT_NEAR(integral_of(with_gaps), alone, 1e-11);  // rounding: between its intervals the weight is 0
  EXPECT_TRUE(std::isinf(wavelengths_of(model)[1]));
}

TEST(SpectralWeight, AveragesATable) {
  // k linear in wavenumber: its mean over two intervals of one weight per cm-1 is that at the middle of both.
  BulkTable table;
  table.wavenumber_cm1 = {1000, 6000};
  table.effective_radius_um = {10};
  table.value = {{{.1, 1, .8}}, {{.6, 1, .8}}};
  const SpectralWeight weight = weight_of_point(solar(), 0);
  const auto average = average_over(table, weight.wavenumber_cm1, weight.weight);
  EXPECT_NEAR(average[0].extinction_m2_per_g, .3, 1e-13);  // rounding
}

}  // namespace
}  // namespace cloudbow
