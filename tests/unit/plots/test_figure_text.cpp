// Texts of figures. Truth: what a typesetter would print.
#include <gtest/gtest.h>

#include "plots/figure_text.hpp"

namespace cloudbow {
namespace {

TEST(FigureText, PlainTextShowsItsCharacters) {
  EXPECT_EQ(plain_text("a < b & c > d"), "a &lt; b &amp; c &gt; d");
  EXPECT_EQ(plain_text("two\nlines\tx"), "two lines x");
  EXPECT_EQ(plain_text("\xff\x1b"), "\\xff\\x1b");
  EXPECT_EQ(plain_text("\u03c4 \u4e91"), "\u03c4 \u4e91");
}

TEST(FigureText, UnitsHaveRaisedExponents) {
  EXPECT_EQ(unit_text("W m-2"), "W\u202fm<sup>\u22122</sup>");
  EXPECT_EQ(unit_text("W m-2 sr-1 um-1"),
            "W\u202fm<sup>\u22122</sup>\u202fsr<sup>\u22121</sup>\u202f\u00b5m<sup>\u22121</sup>");
  EXPECT_EQ(unit_text("m2"), "m<sup>2</sup>");
  EXPECT_EQ(unit_text("degree"), "\u00b0");
  EXPECT_EQ(unit_text("%"), "%");
  EXPECT_EQ(unit_text("1"), "");
  EXPECT_EQ(unit_text(""), "");
  EXPECT_EQ(unit_text("a<b"), "a&lt;b");
}

TEST(FigureText, NamesHaveUnitAndPowerOfTen) {
  EXPECT_EQ(labelled_with_unit("x", "km"), "x [km]");
  EXPECT_EQ(labelled_with_unit("optical depth", "1"), "optical depth");
  EXPECT_EQ(labelled_with_unit("optical depth", "1", 6), "optical depth [10<sup>6</sup>]");
  EXPECT_EQ(labelled_with_unit("heating", "K", -6), "heating [10<sup>\u22126</sup>\u202fK]");
}

TEST(FigureText, NumbersHaveATrueMinus) {
  EXPECT_EQ(number_text(-1.25, 1), "\u22121.2");
  EXPECT_EQ(number_text(-0.001, 1), "0.0");
  EXPECT_EQ(number_text(30, 0), "30");
}

}  // namespace
}  // namespace cloudbow
