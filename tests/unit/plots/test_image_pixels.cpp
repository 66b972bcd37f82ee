// From pixels to values. Truth: pictures small enough to count by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(ImagePixels, ValuesBetweenLevelsAreInterpolatedAndThoseOfCellsAreNot) {
  FluxImage image = two_by_two({0, 50, 100});
  image.value = {0, 8, 4, 16};
  EXPECT_THAT(values_of_pixels(image, 2, 4), ElementsAre(4, 16, 4, 16, 0, 8, 0, 8));
  image.level_m = {0, 100};
  EXPECT_THAT(values_of_pixels(image, 2, 4), ElementsAre(3.5F, 15, 2.5F, 13, 1.5F, 11, 0.5F, 9));
  image.rows = 3;
  image.level_m = {0, 20, 100};  // uneven: the values are those of height / 10 and of a constant
  image.row_edge_m = {0, 10, 60, 100};
  image.value = {0, 5, 2, 5, 10, 5};
  EXPECT_THAT(values_of_pixels(image, 2, 5), ElementsAre(9, 5, 7, 5, 5, 5, 3, 5, 1, 5));
  image.value[5] = std::numeric_limits<float>::quiet_NaN();  // the upper half of its interval has no value
  const std::vector<float> value = values_of_pixels(image, 2, 5);
  EXPECT_TRUE(std::isnan(value[1]) && std::isnan(value[3]));
  EXPECT_THAT(std::vector<float>(value.begin() + 4, value.end()), ElementsAre(5, 5, 3, 5, 1, 5));
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
