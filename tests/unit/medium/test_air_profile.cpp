// Profiles of density. Truth: closed forms, which interpolation gives exactly.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;

class AirFiles : public LesImport {
 protected:
  std::filesystem::path text(const std::string& content) const {
    const auto path = folder_ / "profile.txt";
    std::ofstream(path) << content;
    return path;
  }
  /// Density e^(-z/8 km), whose logarithm is linear.
  static double thin(double z) { return 1.2 * std::exp(-z / 8000); }
};

TEST_F(AirFiles, ADensityByHeightIsInterpolatedByItsLogarithm) {
  CloudImportOptions options = with([](NetcdfBuilder&) {});
  std::string lines = "# height(km) other rho(g/m3)\n";
  for (const double km : {3.0, 1.0, 0.0}) lines += fmt::format("{} 7 {:.10g}\n", km, 1e3 * thin(1000 * km));
  options.profile = text(lines);
  const auto expect = [&](const ImportedCloud& cloud) {
    for (int k = 3; k <= 6; ++k)
      EXPECT_NEAR(
          cloud.field.value[static_cast<std::size_t>((k - 3) * columns)] / (1e3 * water(k, 0, 0) * thin(height(k))), 1,
          1e-6);
  };
  const ImportedCloud cloud = import_cloud(options);
  expect(cloud);
  EXPECT_THAT(notes_of(cloud), HasSubstr("profile.txt at the heights of the cells"));

  NetcdfBuilder file(folder_ / "profile.nc");
  file.dimension("time", 2);
  file.dimension("zh", 3);
  file.variable("zh", {"zh"}, "m", {0, 1000, 3000}, NC_DOUBLE);
  file.variable("rhoh", {"time", "zh"}, "kg m-3", {1, 1, 1, thin(0), thin(1000), thin(3000)}, NC_DOUBLE);
  options.profile = file.close();
  expect(import_cloud(options));

  options.profile = text("# z(m) rho(kg/m3)\n0 1.2\n300 1.1\n");
  EXPECT_THAT(error_of(options),
              AllOf(HasSubstr("profile.txt"), HasSubstr("does not reach the cloud (found heights 0 to 300 m, needed")));
  options.profile = text("# z(m) rho(kg/m3)\n0 1.2\n3000 1100\n");
  EXPECT_THAT(error_of(options), HasSubstr("the density at 3000 m is 1100 kg/m3 (allowed 0.01 to 2 kg/m3)"));
  options.profile = text("0 1.2\n3000 1.1\n");
  EXPECT_THAT(error_of(options), HasSubstr("\"# z(m) rho(kg/m3)\" before the numbers"));
}

TEST_F(AirFiles, PressureAndTemperatureByHeightGiveDensityAndTemperature) {
  CloudImportOptions options = with([](NetcdfBuilder&) {});
  std::string lines = "# z(m) p(Pa) T(K)\n";
  for (int m = 0; m <= 1000; m += 10) {
    const double x = 1 - gravity * m / (heat_capacity * theta);
    lines += fmt::format("{} {:.10g} {:.10g}\n", m, 1e5 * std::pow(x, 3.5), theta * x);
  }
  options.profile = text(lines);
  expect_truth(import_cloud(options));
  options.temperature_grid = true;
  const ImportedCloud cloud = import_cloud(options);
  ASSERT_EQ(cloud.auxiliaries.size(), 1U);
  EXPECT_NEAR(cloud.auxiliaries[0].value[0], kelvin(3), 2e-4);

  // A potential temperature of the file takes the profile's pressure.
  CloudImportOptions dry =
      with([](NetcdfBuilder& file) { file.variable("th", {"z"}, "K", profile([](int) { return theta + 3; })); });
  dry.profile = options.profile;
  dry.temperature_grid = true;
  EXPECT_NEAR(import_cloud(dry).auxiliaries[0].value[0], kelvin(3) * (theta + 3) / theta, 2e-4);
}

}  // namespace
}  // namespace cloudbow
