// Planck's law. Truth: the law of Stefan and Boltzmann, and the limits of Wien and of Rayleigh and Jeans. Numbers with
// 40 digits are quadratures of the law at each wavelength by mpmath 1.2.1 (mp.quad over 12 pieces of equal ratio).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/planck.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double stefan_boltzmann = 5.67037441918442945e-8;  // W m-2 K-4
constexpr double second_constant = 14387.768775039338;       // um K
constexpr double first_constant = 119104297.239718841;       // W m-2 sr-1 um4

double relative(double found, double expected) { return found / expected - 1; }

TEST(Planck, AtAWavelengthIsThatOfFortyDigits) {
  struct Case {
    double wavelength_um, temperature_k, radiance;
  };
  for (const Case& of : {Case{10.8, 288.15, 8.03943752002208223}, Case{.55, 5772, 25734915.4759997376},
                         Case{15, 220, 2.0303147245207438}, Case{3.7, 300, .403287534215327027},
                         Case{100, 1.5, 2.62464270959167736e-44}, Case{.5, 300, 8.39885667069336754e-33}}) {
    // exp(-x) has a relative error of x times the rounding of x, which is 96 in two of these cases.
    EXPECT_NEAR(relative(PlanckFunction::at(of.wavelength_um)(of.temperature_k), of.radiance), 0, 3e-14);
  }
}

TEST(Planck, OverABandIsThatOfFortyDigits) {
  struct Case {
    std::array<double, 2> band_um;
    double temperature_k, radiance, tolerance;
  };
  constexpr double rounding = 2e-14;  // of some 20 terms, and of exp(-x) as above
  for (const Case& of :
       {Case{{8, 12}, 288.15, 31.4780242994408727, rounding}, Case{{10.5, 12.5}, 250, 7.94866708610487511, rounding},
        Case{{4, 100}, 300, 145.199384022008581, rounding}, Case{{.4, .7}, 5772, 7340111.73772201558, rounding},
        Case{{100, 1000}, 300, .687617212326801075, rounding}, Case{{1, 10000}, 300, 146.199834288867517, rounding},
        Case{{4, infinity}, 300, 145.887814257812816, rounding}, Case{{8, 12}, 20, 9.28523278385770234e-25, rounding},
        // Of narrow bands the width itself is rounded: 2e-16 / (relative width).
        Case{{10.79, 10.81}, 288.15, .160788658161819698, 4e-13},
        Case{{10.8, 10.80108}, 288.15, .00868244882842113485, 8e-12}}) {
    EXPECT_NEAR(relative(PlanckFunction::over(of.band_um)(of.temperature_k), of.radiance), 0, of.tolerance)
        << of.band_um[0] << " to " << of.band_um[1] << " um";
  }
}

TEST(Planck, AllWavelengthsTogetherGiveTheLawOfStefanAndBoltzmann) {
  for (const double kelvin : {1., 77., 220., 300., 5772.}) {
    const double all = stefan_boltzmann * kelvin * kelvin * kelvin * kelvin / pi;
    // Wavelengths below 1e-3 um have x > 2000 at 5772 K and below: nothing.
    EXPECT_NEAR(relative(PlanckFunction::over({1e-3, infinity})(kelvin), all), 0, 1e-14) << kelvin;
  }
  const double all = stefan_boltzmann * std::pow(300, 4) / pi;
  // Beyond 1e7 um there are 5 x^3 / pi^4 with x = 4.8e-6.
  EXPECT_NEAR(relative(PlanckFunction::over({.01, 1e7})(300), all), 0, 1e-14);
}

TEST(Planck, ANarrowBandIsTheWavelengthTimesItsWidth) {
  for (const double wavelength : {3.7, 10.8, 50.}) {
    for (const double kelvin : {80., 288., 1000.}) {
      const double half = 1e-4 * wavelength;
      const double band = PlanckFunction::over({wavelength - half, wavelength + half})(kelvin);
      // The curvature of the law leaves x^2 (half / wavelength)^2 / 6 with x < 49.
      EXPECT_NEAR(relative(band / (2 * half), PlanckFunction::at(wavelength)(kelvin)), 0, 5e-6);
    }
  }
}

TEST(Planck, BandsAddUp) {
  // Ends on both sides of every change of method: Gauss-Legendre, series, Bernoulli series.
  const std::vector<double> ends{.5, 2, 4, 8, 8.01, 12, 24, 31, 33, 60, 200, 5000, infinity};
  for (const double kelvin : {50., 200., 288., 500., 3000.}) {
    const double whole = PlanckFunction::over({ends.front(), ends.back()})(kelvin);
    double sum = 0;
    for (std::size_t n = 0; n + 1 < ends.size(); ++n) sum += PlanckFunction::over({ends[n], ends[n + 1]})(kelvin);
    EXPECT_NEAR(relative(sum, whole), 0, 2e-14) << kelvin;  // rounding, as above
  }
}

TEST(Planck, HasTheLimitsOfWienAndOfRayleighAndJeans) {
  const double x = second_constant / (4. * 100);
  EXPECT_NEAR(relative(PlanckFunction::at(4)(100), first_constant / 1024 * std::exp(-x)), 0, std::exp(-x) + 1e-14);
  // 2 c k T / wavelength^4, less x / 2 of it.
  const double long_wave = second_constant / (1e4 * 6000.);
  EXPECT_NEAR(relative(PlanckFunction::at(1e4)(6000), first_constant / second_constant * 6000 / 1e16), -long_wave / 2,
              long_wave * long_wave);
}

TEST(Planck, OfTheColdIsNothingAndNeverNaN) {
  const std::vector<PlanckFunction> functions{PlanckFunction::at(.1), PlanckFunction::at(10.8),
                                              PlanckFunction::over({8, 12}), PlanckFunction::over({4, infinity})};
  for (const PlanckFunction& planck : functions) {
    EXPECT_EQ(planck(0), 0);
    EXPECT_EQ(planck.brightness_temperature(0), 0);
    EXPECT_EQ(planck.brightness_temperature(-1e-20), 0);
    for (double kelvin = 1e-300; kelvin < 1e4; kelvin *= 10) {
      const double radiance = planck(kelvin);
      EXPECT_TRUE(std::isfinite(radiance) && radiance >= 0) << kelvin;
      EXPECT_TRUE(std::isfinite(planck.brightness_temperature(radiance))) << kelvin;
    }
    for (double radiance = 5e-324; radiance < 1e200; radiance *= 1e5) {
      const double kelvin = planck.brightness_temperature(radiance);
      EXPECT_TRUE(std::isfinite(kelvin) && kelvin > 0) << radiance;
    }
    EXPECT_TRUE(std::isnan(planck.brightness_temperature(std::nan(""))));
  }
}

TEST(Planck, BrightnessTemperatureIsTheInverse) {
  std::vector<PlanckFunction> functions{PlanckFunction::over({8, 12}),      PlanckFunction::over({10.5, 12.5}),
                                        PlanckFunction::over({4, 100}),     PlanckFunction::over({4, infinity}),
                                        PlanckFunction::over({.3, 100}),    PlanckFunction::over({10.8, 10.8001}),
                                        PlanckFunction::over({1000, 2000}), PlanckFunction::over({.2, .4})};
  for (double wavelength = .5; wavelength <= 100; wavelength *= 1.3)
    functions.push_back(PlanckFunction::at(wavelength));
  int round_trips = 0;
  for (const PlanckFunction& planck : functions) {
    for (double kelvin = 1; kelvin <= 6000; kelvin *= 1.17) {
      const double radiance = planck(kelvin);
      // Smaller numbers have fewer digits; those that cold matter radiates in visible light are 0.
      if (radiance < std::numeric_limits<double>::min()) continue;
      // Rounding of the radiance and of the temperature.
      EXPECT_NEAR(relative(planck.brightness_temperature(radiance), kelvin), 0, 1e-13);
      ++round_trips;
    }
  }
  EXPECT_GT(round_trips, 1000);
}

TEST(Planck, BrightnessTemperatureOfABandGrowsWithItsRadiance) {
  const PlanckFunction planck = PlanckFunction::over({8, 12});
  double below = 0;
  for (double radiance = 1e-300; radiance < 1e6; radiance *= 3) {
    const double kelvin = planck.brightness_temperature(radiance);
    EXPECT_GT(kelvin, below);
    below = kelvin;
  }
}

std::string message(const auto& make) {
  try {
    make();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Planck, RefusesIntervalsThatAreNone) {
  EXPECT_EQ(message([] { PlanckFunction::at(10800); }),
            "wavelength of thermal emission: out of range (found 10800 um, allowed 0.1 to 10000 um)");
  EXPECT_NE(message([] { PlanckFunction::at(std::nan("")); }), "no error");
  EXPECT_EQ(message([] {
              PlanckFunction::over({12, 8});
            }),
            "band of thermal emission: wrong ends (found 12 to 8 um, allowed two ascending wavelengths > 0)");
  for (const std::array<double, 2> band :
       {std::array{8., 8.}, {0., 8.}, {-1., 8.}, {infinity, infinity}, {std::nan(""), 8.}, {8., std::nan("")}})
    EXPECT_NE(message([&] { PlanckFunction::over(band); }), "no error");
}

}  // namespace
}  // namespace cloudbow
