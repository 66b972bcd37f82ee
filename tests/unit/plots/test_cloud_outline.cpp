// The outline of clouds. Truth: faces counted by hand; the length around boxes.
#include <gtest/gtest.h>

#include <cmath>

#include "plots/cloud_outline.hpp"

namespace cloudbow {
namespace {

FluxImage section(int columns, std::vector<double> row_edge_m, std::vector<float> extinction) {
  FluxImage image;
  image.columns = columns;
  image.column_start_m = -100;
  image.column_width_m = 50;
  image.clouds = SectionClouds{std::move(extinction), std::move(row_edge_m)};
  return image;
}

void expect_piece(const OutlinePiece& piece, double from_x, double from_y, double to_x, double to_y) {
  EXPECT_EQ(piece.from_x, from_x);
  EXPECT_EQ(piece.from_y, from_y);
  EXPECT_EQ(piece.to_x, to_x);
  EXPECT_EQ(piece.to_y, to_y);
}

// Two cells beside each other, of which one alone reaches one row higher:
//   . # . .   300 to 400 m
//   . # # .   200 to 300 m
//   . . . .     0 to 200 m
TEST(CloudOutline, GoesAroundTheCellsInLongPieces) {
  const FluxImage image = section(4, {0, 200, 300, 400}, {0, 0, 0, 0, 0, 1, 2, 0, 0, 3, 0, 0});
  const std::vector<OutlinePiece> pieces = cloud_outline(image, .5);
  ASSERT_EQ(pieces.size(), 5U);
  expect_piece(pieces[0], -50, 200, 50, 200);
  expect_piece(pieces[1], 0, 300, 50, 300);
  expect_piece(pieces[2], -50, 200, -50, 400);
  expect_piece(pieces[3], 0, 300, 0, 400);
  expect_piece(pieces[4], 50, 200, 50, 300);
}

TEST(CloudOutline, HasNoPieceAtTheRimOfTheSectionOrWithoutContrast) {
  const auto pieces = [](float everywhere, double threshold) {
    return cloud_outline(section(2, {0, 1, 2}, std::vector<float>(4, everywhere)), threshold);
  };
  EXPECT_TRUE(pieces(1, .5).empty());
  EXPECT_TRUE(pieces(0, .5).empty());
  EXPECT_TRUE(pieces(.5F, .5).empty()) << "the threshold itself is not exceeded";
}

// Cells that touch at a corner alone are two boxes.
TEST(CloudOutline, LengthIsThatAroundAllCells) {
  const FluxImage image = section(4, {0, 50, 100, 150, 200}, {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0});
  double length = 0;
  for (const OutlinePiece& piece : cloud_outline(image, 0))
    length += std::hypot(piece.to_x - piece.from_x, piece.to_y - piece.from_y);
  EXPECT_DOUBLE_EQ(length, 2 * 4 * 50);
}

}  // namespace
}  // namespace cloudbow
