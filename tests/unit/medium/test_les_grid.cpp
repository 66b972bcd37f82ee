// Columns of LES files. Truth: closed forms of their sizes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <numbers>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;

TEST_F(LesImport, DegreesBecomeMetres) {
  constexpr double step = 0.001, latitude = 50, metre = 6371229 * std::numbers::pi / 180;
  const auto globe = [&](double step_y) {
    NetcdfBuilder file(folder_ / "globe.nc");
    file.dimension("z", nz);
    file.dimension("lat", ny);
    file.dimension("lon", nx);
    file.variable("z", {"z"}, "m", profile(height));
    file.variable("lat", {"lat"}, "degrees_north", {latitude + step_y, latitude, latitude - step_y});
    file.variable("lon", {"lon"}, "degrees_east", {8, 8 + step});
    file.variable("qc", {"z", "lat", "lon"}, "kg/kg",
                  field([](int k, int j, int i) { return water(k, ny - 1 - j, i); }));
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    CloudImportOptions options;
    options.file = file.close();
    return options;
  };
  const ImportedCloud cloud = import_cloud(globe(step));
  EXPECT_NEAR(cloud.field.cell_size_m[0] / (step * metre * std::cos(latitude * std::numbers::pi / 180)), 1, 2e-3);
  EXPECT_NEAR(cloud.field.cell_size_m[1] / (step * metre), 1, 2e-3);                 // numbers of 32 bits
  EXPECT_NEAR(cloud.field.value[0] / (1e3 * water(3, 0, 0) * density(3)), 1, 1e-5);  // from south to north
  EXPECT_THAT(notes_of(cloud), HasSubstr("in degrees at the mean latitude 50"));
  EXPECT_THAT(error_of(globe(2)),
              AllOf(HasSubstr("columns differ in width by more than 0.02"), HasSubstr("--voxel-size-m")));
}

TEST_F(LesImport, AProfileIsNoCloudOfColumnsWithoutWidth) {
  CloudImportOptions options =
      with([](NetcdfBuilder& file) { file.variable("rho", {"z"}, "kg/m3", profile(density)); });
  options.variable = "rho";
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("'rho' is a profile"), HasSubstr("no axis but z"),
                                       HasSubstr("--variable"), HasSubstr("--voxel-size-m")));
}

}  // namespace
}  // namespace cloudbow
