// Albedo by wavelength. Truth: means by hand, and the numbers in the files that the tests write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/spectral_albedo.hpp"
#include "fake_gas_model.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Intervals of .5 to 1 um and 1 to 2 um, of equal power per wavenumber; the third g-point has both.
FakeGasModel two_intervals() {
  return {GasModel::Light::solar,
          {.lower = {5000, 10000}, .upper = {10000, 20000}, .solar = {1, 2}},
          {{.5, 0}, {0, .5}, {.5, .5}}};
}

TEST(SpectralAlbedo, OfOneValueIsThatOfAllPoints) {
  for (const SpectralAlbedo& constant : {SpectralAlbedo{{.7}, {.3}}, SpectralAlbedo{{.4, 3}, {.3, .3}}}) {
    for (const double albedo : albedo_of_points(two_intervals(), constant, "a")) EXPECT_NEAR(albedo, .3, 1e-14);
  }
}

TEST(SpectralAlbedo, IsLinearInWavelength) {
  // A = lambda / 2 um: over wavenumbers from 1/b to 1/a its mean is ln(b/a) / (2 (1/a - 1/b)).
  const auto albedo = albedo_of_points(two_intervals(), {{.1, 2}, {.05, 1}}, "a");
  const double near_infrared = std::log(2.0) / 2 / .5, visible = std::log(2.0) / 2;
  // Nodes 1.25 % apart, between which the curve is a chord: .0125^2 / 12.
  EXPECT_NEAR(albedo[0], near_infrared, 2e-5);
  EXPECT_NEAR(albedo[1], visible, 2e-5);
  EXPECT_NEAR(albedo[2], (near_infrared + 2 * visible) / 3, 2e-5);
}

TEST(SpectralAlbedo, KeepsItsLastValueForASmallPartOfThePower) {
  // Beyond 1.8 um lie 5000 to 5556 cm-1 of 15000.
  const auto albedo = albedo_of_points(two_intervals(), {{.4, 1, 1.0001, 1.8}, {.1, .1, .5, .5}}, "a");
  EXPECT_NEAR(albedo[0], .5, 1e-4);  // the slope at 1 um
  EXPECT_NEAR(albedo[1], .1, 1e-4);
  EXPECT_THAT(
      [] {
        albedo_of_points(two_intervals(), {{.4, .8}, {.1, .2}}, "soil.txt");
      },
      ThrowsMessage<InputError>(HasSubstr("soil.txt: lacks 0.5 to 2 um (found 0.4 to 0.8, 50 % beyond, allowed 10)")));
}

TEST(SpectralAlbedo, ChecksPairs) {
  const auto expect_refused = [](const SpectralAlbedo& albedo, const char* text) {
    EXPECT_THAT([&] { check_spectral_albedo(albedo, "a"); }, ThrowsMessage<InputError>(HasSubstr(text)));
  };
  expect_refused({}, "a: spectral albedo: no pairs");
  expect_refused({{.5, .6}, {.1}}, "no pairs (found 2 wavelengths and 1 albedos");
  expect_refused({{500}, {1.2}}, "albedo out of range (found 1.2 at 500 um");
  expect_refused({{550, 1200}, {.1, .1}}, "wavelength out of range (found 1200 um");
  expect_refused({{.5, .5}, {.1, .1}}, "do not ascend");
}

class SpectralAlbedoFile : public testing::Test {
 protected:
  void TearDown() override { fs::remove(file()); }
  static fs::path file() { return fs::temp_directory_path() / ("cloudbow_albedo_" + std::to_string(getpid())); }
  static SpectralAlbedo read(const std::string& text) {
    std::ofstream(file()) << text;
    return read_spectral_albedo(file());
  }
  static void expect_refused(const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { read(text); }, ThrowsMessage<InputError>(HasSubstr(file().string() + message)));
  }
};

TEST_F(SpectralAlbedoFile, HasTwoColumns) {
  const SpectralAlbedo albedo = read("# grass\n\n0.4 0.05\n0.8, 0.45 \n");
  EXPECT_THAT(albedo.wavelength_um, ElementsAre(.4, .8));
  EXPECT_THAT(albedo.albedo, ElementsAre(.05, .45));
}

TEST_F(SpectralAlbedoFile, ObeysUnitsAndOrder) {
  const SpectralAlbedo albedo = read("# wavelength (nm)  Albedo(%)\n800 45\n400 5\n");
  EXPECT_THAT(albedo.wavelength_um, ElementsAre(DoubleEq(.4), DoubleEq(.8)));
  EXPECT_THAT(albedo.albedo, ElementsAre(DoubleEq(.05), DoubleEq(.45)));
}

TEST_F(SpectralAlbedoFile, RefusesWithTheLine) {
  expect_refused("0.4 0.1\n0.5\n", ":2: not two columns (found 1");
  expect_refused("lambda albedo\n", ":1: not a number (found \"lambda\"");
  expect_refused("# wavelength(furlong) albedo\n0.4 0.1\n", ":1: column wavelength: unit not known (found \"furlong\"");
  expect_refused("# only words\n", ": spectral albedo: no pairs");
  expect_refused("400 0.1\n3000 0.2\n", ": wavelength out of range (found 3000 um, allowed 0.1 to 1000 um)");
  expect_refused("0.4 nan\n", ": albedo out of range");
  EXPECT_THROW(read_spectral_albedo("no_such_file"), InputError);
}

}  // namespace
}  // namespace cloudbow
