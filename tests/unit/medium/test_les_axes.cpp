// Axes of LES files. Truth: the order of the numbers that the files are made of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;

TEST_F(LesImport, UnstructuredGridsAreRefusedWithTheWayOut) {
  NetcdfBuilder file(folder_ / "cells.nc");
  file.dimension("height", nz);
  file.dimension("ncells", columns);
  file.variable("qc", {"height", "ncells"}, "kg/kg", field(water));
  CloudImportOptions options;
  options.file = file.close();
  EXPECT_THAT(error_of(options), HasSubstr("'ncells' counts the cells of an unstructured grid"));
}

TEST_F(LesImport, ColumnsThatDescendAreTurnedRound) {
  NetcdfBuilder file(folder_ / "turned.nc");
  file.dimension("z", nz);
  file.dimension("y", ny);
  file.dimension("x", nx);
  file.variable("z", {"z"}, "m", profile(height));
  file.variable("y", {"y"}, "m", {250, 150, 50});
  file.variable("x", {"x"}, "m", {150, 50});
  file.variable("rho", {"z"}, "kg/m3", profile(density));
  file.variable("qc", {"z", "y", "x"}, "kg/kg",
                field([](int k, int j, int i) { return water(k, ny - 1 - j, nx - 1 - i); }));
  CloudImportOptions options;
  options.file = file.close();
  const ImportedCloud cloud = import_cloud(options);
  expect_truth(cloud);
  EXPECT_EQ(cloud.field.min_m[0], 0);
  EXPECT_EQ(cloud.field.min_m[1], 0);
}

}  // namespace
}  // namespace cloudbow
