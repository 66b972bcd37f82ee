// Text below a head of sizes and levels. Truth: the numbers of the text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "import_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

TEST_F(CloudImport, TextBelowAHeadOfSizesAndLevels) {
  const std::string head = "# cloud\n2,2,3 # nx,ny,nz\n0.02,0.03 # dx,dy [km, km]\n0.44,0.48,0.52 # levels [km]\n";
  const std::string columns = "x,y,z,lwc,reff\n";
  const ImportedCloud at3d =
      import_cloud(options_for(write("at3d.csv", head + columns + "0,0,1,0.5,10.0\n1,1,2,0.3,8.0\n")));
  EXPECT_EQ(at3d.field.cells, (std::array<int, 3>{2, 2, 3}));
  EXPECT_EQ(at3d.field.quantity, "liquid_water_content");
  EXPECT_NEAR(at3d.field.cell_size_m[1], 30, 1e-9);
  EXPECT_NEAR(at3d.field.min_m[2], 420, 1e-9);
  EXPECT_THAT(at3d.field.value, testing::ElementsAre(0.5F, 0.3F));
  EXPECT_THAT(at3d.auxiliaries.at(0).value, testing::ElementsAre(10, 8));
  EXPECT_THAT(column_integrals(at3d.field),
              testing::ElementsAre(testing::DoubleNear(20, 1e-6), 0, 0, testing::DoubleNear(12, 1e-6)));

  const ImportedCloud mystic =
      import_cloud(options_for(write("wc3d.dat", "2 2 2 3\n0.1 0.1 0.5 0.6 0.7\n1 1 1 0.5 10.0\n2 1 2 0.3 8.0\n")));
  EXPECT_EQ(mystic.field.cells, (std::array<int, 3>{2, 2, 2}));
  EXPECT_NEAR(mystic.field.min_m[2], 500, 1e-9);
  EXPECT_THAT(mystic.auxiliaries.at(0).value, testing::ElementsAre(10, 8));
  const ImportedCloud optics =
      import_cloud(options_for(write("wc3d.dat", "1 1 2 1\n0.1 0.1 0.5 0.6 0.7\n1 1 1 20 0.85 0.99\n")));
  EXPECT_EQ(optics.field.quantity, "extinction");
  EXPECT_THAT(optics.field.value, testing::ElementsAre(0.02F));
  EXPECT_THAT(optics.auxiliaries.at(0).value, testing::ElementsAre(0.99F));

  const auto error = [&](const std::string& text) {
    return message_of([&] { import_cloud(options_for(write("wrong.txt", text))); });
  };
  EXPECT_THAT(error(head + columns + "0,0,3,0.5,10\n"), HasSubstr("wrong.txt:6: index along z out of range"));
  EXPECT_THAT(error(head + columns + "0,0,1,50,10\n"), HasSubstr("(allowed up to 20 g/m3)"));
  EXPECT_THAT(error(head + columns + "0,0,1,0.5,1e-5\n"), HasSubstr("(allowed 0.1 to 5000 um)"));
  EXPECT_THAT(error(head + columns + "0,0,1,0.5,10\n0,0,1,0.5,10\n"), HasSubstr("there twice"));
  EXPECT_THAT(error("1 1 2 3\n0.1 0.1 0.5 0.6 0.6\n1 1 1 0.5 10\n"), HasSubstr("levels do not ascend"));
  EXPECT_THAT(error("1.5 1 2 3\n0.1 0.1 0.5 0.6 0.7\n1 1 1 0.5 10\n"), HasSubstr("found 1.5 x 1 x 2, allowed whole"));
  EXPECT_THAT(error("1 1 2 3\n0.1 0.1 500 600 70000\n1 1 1 0.5 10\n"), HasSubstr("m thick"));
}

}  // namespace
}  // namespace cloudbow
