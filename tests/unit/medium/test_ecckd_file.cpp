// ecCKD files that are wrong. Truth: one message that names the file and the variable.
#include <gmock/gmock.h>

#include <cmath>

#include "../app/temporary_folder.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/optics/planck.hpp"
#include "ecckd_example.hpp"
#include "gas_test_tools.hpp"

namespace cloudbow {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using namespace ecckd_example;

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
