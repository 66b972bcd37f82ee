// From pixels to values. Truth: pictures small enough to count by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plots/image_pixels.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;

FluxImage two_by_two(std::vector<double> row_edge_m) {
  FluxImage image;
  image.columns = image.rows = 2;
  image.column_width_m = 50;
  image.row_edge_m = std::move(row_edge_m);
  return image;
}

TEST(ImagePixels, RowsStandFromTheTopAndHaveTheirHeight) {
  EXPECT_THAT(cells_of_pixels(two_by_two({0, 50, 100}), 2, 2), ElementsAre(2, 3, 0, 1));
  EXPECT_THAT(cells_of_pixels(two_by_two({0, 25, 100}), 2, 4), ElementsAre(2, 3, 2, 3, 2, 3, 0, 1));
}

TEST(ImagePixels, SectionsAreStretchedAndMapsAreNot) {
  FluxImage image = two_by_two({0, 5, 10});
  EXPECT_DOUBLE_EQ(aspect_of(image), 0.1);
  image.rows_along = "z";
  EXPECT_DOUBLE_EQ(aspect_of(image), 0.25);
  image.row_edge_m = {0, 500, 1000};
  EXPECT_DOUBLE_EQ(aspect_of(image), 4);
  image.place = "column";
  EXPECT_DOUBLE_EQ(aspect_of(image), 1);
}

}  // namespace
}  // namespace cloudbow
