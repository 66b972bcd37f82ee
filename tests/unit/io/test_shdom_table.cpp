// Droplet tables in SHDOM's form. Truth: the numbers of the text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "droplet_file_tools.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* shdom =
    "! Mie scattering table vs. effective radius (LWC=1 g/m^3)\n"
    "    0.660    0.680  wavelength range (micron)\n"
    "  1.000  W   particle density (g/cm^3) and type (Water, Ice, Aerosol)\n"
    "  1.331000E+00 -2.000000E-08  particle index of refraction\n"
    "  7.00000 gamma size distribution shape parameter\n"
    "   2    5.000   10.000  number, starting, ending effective radius\n"
    "   5.0000  3.01000E+02 0.990000      4   Reff  Ext  Alb  Nleg\n"
    "     1.00000   1.27500   0.60000   0.06000\n"
    "     0.04500\n"
    "  10.0000  1.51000D+02 0.980000      3   Reff  Ext  Alb  Nleg\n"
    "     1.00000   1.35000   0.70000   0.06300\n";

TEST_F(DropletTableFile, ReadsShdom) {
  const DropletTable table = read_droplet_table(write_text(shdom));
  EXPECT_DOUBLE_EQ(table.wavelength_um, 0.67);
  EXPECT_EQ(table.effective_radius_um, (std::vector<double>{5, 10}));
  EXPECT_DOUBLE_EQ(table.extinction_m2_per_g[0], 0.301);  // 301 1/km for 1 g/m3
  EXPECT_DOUBLE_EQ(table.extinction_m2_per_g[1], 0.151);  // Fortran's D exponent
  EXPECT_DOUBLE_EQ(table.single_scattering_albedo[1], 0.98);
  ASSERT_EQ(table.moments[0].size(), 5u);
  EXPECT_DOUBLE_EQ(table.moments[0][1], 0.425);
  EXPECT_DOUBLE_EQ(table.moments[0][4], 0.005);
  EXPECT_DOUBLE_EQ(table.moments[1][3], 0.009);
  std::string upper = shdom;  // heads in any case
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  EXPECT_EQ(read_droplet_table(write_text(upper)).moments, table.moments);
}

// Polarised tables: six elements, each one line that begins with its number; the first is the phase function.
TEST_F(DropletTableFile, ReadsShdomPolarised) {
  std::string text =
      "! Polarized Mie scattering table vs. effective radius (LWC=1 g/m^3)\n"
      " 0.672 0.672  wavelength range (micron)\n"
      " 1 10.0 10.0  number, starting, ending effective radius\n"
      " 10.0000 1.5E+02 0.98 3  Reff  Ext  Alb  Nrank\n"
      " 1 1.0 1.35 0.7 0.063\n";
  for (int element = 2; element <= 6; ++element) text += " " + std::to_string(element) + " 0.0 0.1 0.2 0.3\n";
  const DropletTable table = read_droplet_table(write_text(text));
  EXPECT_EQ(table.moments[0].size(), 4u);
  EXPECT_DOUBLE_EQ(table.moments[0][1], 0.45);
}

TEST_F(DropletTableFile, SaysWhatIsWrongWithShdomsForm) {
  const auto message_after = [&](const std::string& from, const std::string& to) {
    std::string text = shdom;
    text.replace(text.find(from), from.size(), to);
    return message(write_text(text));
  };
  EXPECT_THAT(message_after("     0.04500\n", ""), AllOf(HasSubstr("found 4, allowed 5"), HasSubstr("radius 5 um")));
  EXPECT_THAT(message_after("   2    5.000", "   3    5.000"), HasSubstr("incomplete (found 2 effective radii"));
  EXPECT_THAT(message_after("3.01000E+02", "abc"), HasSubstr("line 7"));
  EXPECT_THAT(message_after("0.980000      3", "0.980000    3.5"), HasSubstr("line 10: not the head of a radius"));
  EXPECT_THAT(message_after(" 1.00000   1.35000", " 0.50000   1.35000"), HasSubstr("wrong norm"));
  EXPECT_THAT(message_after("1.35000", "3.70000"), HasSubstr("out of range"));
  EXPECT_THAT(message_after("1.35000", "2.70000"), AllOf(HasSubstr("radius 10 um"), HasSubstr("negative")));
  EXPECT_THAT(message_after("10.0000", " 4.0000"), HasSubstr("do not ascend"));
  EXPECT_THAT(message_after("0.06300", "3.14000"), HasSubstr("too few moments"));
}

}  // namespace
}  // namespace cloudbow
