// Variables of LES files. Truth: the names that the files are made of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;

TEST_F(LesImport, VariablesComeFromFurtherFiles) {
  NetcdfBuilder other(folder_ / "air.nc");
  other.dimension("time", 1);
  other.dimension("z", nz);
  other.variable("rho", {"time", "z"}, "kg/m3", profile(density));
  other.variable("qc", {"z"}, "kg/kg", profile([](int) { return 7; }));
  const std::filesystem::path air = other.close();
  CloudImportOptions options = with([](NetcdfBuilder&) {});
  EXPECT_THAT(error_of(options), HasSubstr("--with FILE (more variables)"));
  options.with = {air};
  expect_truth(import_cloud(options));  // its own water, the density of the other file

  NetcdfBuilder short_one(folder_ / "short.nc");
  short_one.dimension("z", nz - 1);
  short_one.variable("rho", {"z"}, "kg/m3", profile(density, nz - 1));
  options.with = {short_one.close()};
  EXPECT_THAT(error_of(options), HasSubstr("'rho' (air density): dimension 'z' is not one of the cloud's"));
}

}  // namespace
}  // namespace cloudbow
