// SHDOM's files. Truth: the numbers of the files, and the layout of SHDOM's documentation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "import_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

TEST_F(CloudImport, ShdomPropertyFile) {
  const std::string head =
      "Tabulated phase function property file\n 2 1 3\n 0.02 0.03  0.1 0.14 0.18\n 2\n 2 1.5 0.5\n 3 2.4\n 1.5\n 0.7\n";
  const ImportedCloud cloud = import_cloud(
      options_for(write("a.prp", head + "1 1 2 290.0 5.0 0.99 2\n2 1 2 290.0 10.0 0.9 1\n1 1 1 290 0 1 1\n")));
  EXPECT_EQ(cloud.field.cells, (std::array<int, 3>{2, 1, 3}));
  EXPECT_NEAR(cloud.field.min_m[2], 80, 1e-9);
  EXPECT_NEAR(cloud.field.cell_size_m[2], 40, 1e-9);
  EXPECT_THAT(cloud.field.value, testing::ElementsAre(0.005F, 0.01F));
  EXPECT_THAT(cloud.auxiliaries[0].value, testing::ElementsAre(0.99F, 0.9F));
  EXPECT_THAT(cloud.auxiliaries[1].value, testing::ElementsAre(2, 1));
  ASSERT_EQ(cloud.moments.size(), 2U);
  EXPECT_THAT(cloud.moments[0], testing::ElementsAre(1, 0.5, 0.1));
  EXPECT_THAT(cloud.moments[1],
              testing::ElementsAre(1, testing::DoubleEq(0.8), testing::DoubleEq(0.3), testing::DoubleEq(0.1)));

  const auto error = [&](const std::string& text) {
    return message_of([&] { import_cloud(options_for(write("b.prp", text))); });
  };
  EXPECT_THAT(error(head + "3 1 2 290.0 5.0 0.99 2\n"),
              HasSubstr("b.prp:9: index along x out of range (found 3, allowed 1 to 2)"));
  EXPECT_THAT(error(head + "1 1 2 290.0 5.0 1.2 2\n"), HasSubstr("single-scattering albedo is 1.2"));
  EXPECT_THAT(error(head + "1 1 2 290.0 5.0 1 3\n"), HasSubstr("allowed 1 to 2"));
  EXPECT_THAT(error(head.substr(0, 75)), HasSubstr("the file ends before"));
  EXPECT_THAT(error("Quick property file\n"), HasSubstr("begins with 'Q'"));
}

TEST_F(CloudImport, ShdomWaterFiles) {
  const std::string grid = "1 1 2\n0.1 0.1\n0.5 0.6\n290 289\n";
  const auto one = import_cloud(options_for(write("1.lwc", "1 parameter LWC file\n" + grid + "1 1 2 0.3\n")));
  EXPECT_EQ(one.field.quantity, "liquid_water_content");
  EXPECT_THAT(one.field.value, testing::ElementsAre(0.3F));
  EXPECT_TRUE(one.auxiliaries.empty());
  const auto two =
      import_cloud(options_for(write("2.lwc", "2 parameter LWC file\n" + grid + "1 1 1 0.3 8\n1 1 2 0.0 0\n")));
  EXPECT_THAT(two.auxiliaries.at(0).value, testing::ElementsAre(8));
  const auto three = import_cloud(
      options_for(write("3.part", "3 propgen particle file\n" + grid + "1 1 1 2 1 0.3 8 2 0.1 40\n1 1 2 0\n")));
  EXPECT_THAT(three.field.value, testing::ElementsAre(0.3F));
  EXPECT_THAT(three.auxiliaries.at(0).value, testing::ElementsAre(8));
}

TEST_F(CloudImport, TextIsReadAsFortranWritesIt) {
  const std::string whole = "1 parameter LWC file\n2 1 3\n0.1 0.1\n0.5 0.6 0.7\n290 290 290\n1 1 2 0.3\n";
  const std::string listed = "1 PARAMETER LWC FILE\n2 1 3\n2*1.0D-1\n5.0d-1 .6 7.D-1\n3*290\n2*1 2 3.0D-01\n";
  const CloudField a = import_cloud(options_for(write("a.lwc", whole))).field;
  const CloudField b = import_cloud(options_for(write("b.lwc", listed))).field;
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.min_m, b.min_m);
  EXPECT_EQ(import_cloud(options_for(write("c.prp",
                                           "e: extinction only PROPERTY FILE\n1 1 2\n.1 .1 .5 .6\n2*280\n"
                                           "1.0 1 1.5\n1 1 1 5.0D0\n")))
                .field.quantity,
            "extinction");
  auto options = options_for(write("columns.txt", "2*0 1 5.0D-1\n2 1 3 2.5d-1\n"));
  options.voxel_size_m = {20, 30, 40};
  EXPECT_THAT(import_cloud(options).field.value, testing::ElementsAre(0.5F, 0.25F));
  options.file = write("many.txt", "0 0 0 1\n1000001*0\n");
  EXPECT_THAT(message_of([&] { import_cloud(options); }), HasSubstr("many.txt:2: not four numbers"));
  options.file = write("repeats.txt", "0 0 0 1\n999999*0 999999*0\n");
  EXPECT_THAT(message_of([&] { import_cloud(options); }), HasSubstr("too many numbers"));
}

}  // namespace
}  // namespace cloudbow
