// Optics of the air as a file. Truth: the numbers that were written, as the netCDF library reads them.
#include <gtest/gtest.h>

#include "cloudbow/io/gas_optics_file.hpp"
#include "medium/netcdf_input.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

GasOpticsData some_data(GasModel::Light light) {
  GasOpticsData data;
  data.light = light;
  data.height_m = {0, 100, 300};
  data.pressure_pa = {1e5, 9.9e4, 9.7e4};
  data.temperature_k = {290, 289, 287};
  data.optics.absorption = {{1, 2}, {3, 4}, {5, 6}};
  data.source = "cloudbow";
  data.history = "then";
  if (light == GasModel::Light::solar) {
    data.optics.rayleigh = {{.1, .2}, {.3, .4}, {.5, .6}};
    data.solar_share = {.25, .25, .5};
  } else {
    data.planck = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  }
  return data;
}

std::vector<double> values(const NetcdfInput& file, const char* name) {
  const NetcdfVariable* variable = file.find(name);
  EXPECT_NE(variable, nullptr) << name;
  return variable == nullptr ? std::vector<double>() : file.read(*variable);
}

TEST(GasOpticsFile, HoldsDepthsAndSunOfASolarModel) {
  const TemporaryFolder folder;
  write_gas_optics(folder / "a.nc", some_data(GasModel::Light::solar));
  const NetcdfInput file(folder / "a.nc");
  EXPECT_EQ(file.global_text("light"), "solar");
  EXPECT_EQ(values(file, "z_edge"), (std::vector<double>{0, 100, 300}));
  EXPECT_EQ(values(file, "layer"), (std::vector<double>{50, 200}));
  EXPECT_EQ(values(file, "absorption_optical_depth"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(values(file, "rayleigh_optical_depth"), (std::vector<double>{.1, .2, .3, .4, .5, .6}));
  EXPECT_EQ(values(file, "solar_share"), (std::vector<double>{.25, .25, .5}));
  EXPECT_EQ(file.find("planck_radiance"), nullptr);
}

TEST(GasOpticsFile, HoldsRadiancesOfALongwaveModel) {
  const TemporaryFolder folder;
  write_gas_optics(folder / "a.nc", some_data(GasModel::Light::longwave));
  const NetcdfInput file(folder / "a.nc");
  EXPECT_EQ(file.global_text("light"), "longwave");
  EXPECT_EQ(values(file, "planck_radiance"), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(file.find("rayleigh_optical_depth"), nullptr);
  const NetcdfVariable* planck = file.find("planck_radiance");
  EXPECT_EQ(planck->dimension, (std::vector<std::string>{"g_point", "z_edge"}));
  EXPECT_EQ(planck->units, "W m-2 sr-1");
}

}  // namespace
}  // namespace cloudbow
