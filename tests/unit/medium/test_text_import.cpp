// Clouds as text columns. Truth: the numbers of the text, and sums over levels as they are written there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "import_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

TEST_F(CloudImport, TextColumns) {
  auto options = options_for(write("cloud.txt", "# i j k value\ni j k extinction\n0 0 1 0.5\n2 1 3 0.25\n"));
  options.format = "columns";
  options.voxel_size_m = {20, 30, 40};
  options.columns = {4, 2};
  const CloudField field = import_cloud(options).field;
  EXPECT_EQ(field.cells, (std::array<int, 3>{4, 2, 4}));
  EXPECT_EQ(field.quantity, "extinction");
  EXPECT_EQ(column_integrals(field), (std::vector<double>{20, 0, 0, 0, 0, 0, 10, 0}));

  options.file = write("commas.txt", ",,\n0 0 1 0.5\n , ,\n2 1 3 0.25\n");  // no words, as in a blank line
  EXPECT_EQ(import_cloud(options).field.active_voxels(), 2U);

  const auto error = [&](const std::string& text) {
    options.file = write("wrong.txt", text);
    return message_of([&] { import_cloud(options); });
  };
  EXPECT_THAT(error("0 0 0 1\n0 0 1\n"), HasSubstr("wrong.txt:2: not four numbers"));
  EXPECT_THAT(error("0 0 0 -1\n"), HasSubstr("value is -1"));
  EXPECT_THAT(error("0 0 0 nan\n"), HasSubstr("value is nan"));
  EXPECT_THAT(error("0 0 -1 1\n"), HasSubstr("index along z out of range"));
  EXPECT_THAT(error("9 0 0 1\n"), HasSubstr("outside the domain"));
  EXPECT_THAT(error("0 0 0 1\n0 0 0 1\n"), HasSubstr("there twice"));
  options.memory_limit_bytes = 100'000;
  EXPECT_THAT(error("0 0 1000 1\n"), HasSubstr("too large for the memory (found 4 x 2 x 1001 cells"));
  options.voxel_size_m.reset();
  EXPECT_THAT(error("0 0 0 1\n"), HasSubstr("--voxel-size-m"));
}

TEST_F(CloudImport, CellsWithOpticsOnStretchedLevels) {
  auto options = options_for(write("cells.csv",
                                   "ix,iz,z_bottom_km,z_top_km,extinction_per_km,ssa,phase_index\n"
                                   "0,0,0.40,0.45,10,0.9,2\n0,1,0.45,0.475,20,0.8,3\n1,2,0.475,0.5,40,1,4\n"));
  options.columns = {3, 1};
  options.voxel_size_m = {55, 55, 55};
  const ImportedCloud cloud = import_cloud(options);
  EXPECT_EQ(cloud.field.cells, (std::array<int, 3>{3, 1, 4}));  // of 25 m: exact
  EXPECT_NEAR(cloud.field.min_m[2], 400, 1e-9);
  EXPECT_THAT(cloud.field.value, testing::ElementsAre(0.01F, 0.01F, 0.02F, 0.04F));
  ASSERT_EQ(cloud.auxiliaries.size(), 2U);
  EXPECT_THAT(cloud.auxiliaries[0].value, testing::ElementsAre(0.9F, 0.9F, 0.8F, 1.0F));
  EXPECT_THAT(cloud.auxiliaries[1].value, testing::ElementsAre(2, 2, 3, 4));
  // Coarser: extinction and scattering of the column stay.
  options.vertical_size_m = 50;
  const ImportedCloud coarse = import_cloud(options);
  EXPECT_NEAR(column_integrals(coarse.field)[0], 1.0, 1e-6);
  double scattering = 0;
  for (std::size_t n = 0; n < coarse.field.value.size(); ++n) {
    scattering += coarse.field.value[n] * coarse.auxiliaries[0].value[n] * 50;
  }
  EXPECT_NEAR(scattering, 0.5 * 0.9 + 0.5 * 0.8 + 1, 1e-6);
}

// Numbers of cells that no int holds were cast to one.
TEST_F(CloudImport, NumbersOfCellsInACommentAreWhole) {
  const auto options = [&](const std::string& shape) {
    return options_for(write("cells.csv", "# nx,ny,nz=" + shape +
                                              "\n# dx=0.05 km dy=0.05 km\n# z levels km: 0.1 0.2 0.3\n"
                                              "ix,iy,iz,extinction_per_km,ssa,iphase\n0,0,0,10,0.99,1\n"));
  };
  for (const char* shape : {"1e300,2,3", "2,1e10,3", "2,2,1e300", "2.5,2,3", "-2,2,3", "2,2,nan", "2,2", "2,x,3"}) {
    EXPECT_THAT(message_of([&] { import_cloud(options(shape)); }),
                HasSubstr("cells.csv:1: no numbers of cells nx,ny,nz"))
        << shape;
  }
  EXPECT_EQ(import_cloud(options("4,2,3")).field.cells, (std::array<int, 3>{4, 2, 3}));
  EXPECT_EQ(import_cloud(options("the numbers of cells")).field.cells, (std::array<int, 3>{1, 1, 3}));
}

}  // namespace
}  // namespace cloudbow
