// Fields on the same voxels. Truth: voxels counted by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud_test_tools.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/joined_fields.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::array<double, 3> size{10, 20, 30};

/// Two rows of three cells: . 1 2 and 4 . .
CloudField low() { return make_cloud_field({3, 2, 1}, size, {0, 0, 0}, {0, 1, 2, 4, 0, 0}, "extinction"); }
/// One cell to the right of the middle of low(), one above it and one beyond: 8 . and, one level higher, 16 32.
CloudField high() { return make_cloud_field({2, 1, 2}, size, {20, 0, 0}, {8, 0, 16, 32}, "extinction"); }

TEST(JoinedFields, ShareTheBoxOfAll) {
  CloudField a = low(), b = high();
  CloudField* const fields[]{&a, &b};
  share_box(fields);
  for (const CloudField* field : fields) {
    EXPECT_EQ(field->cells, (std::array<int, 3>{4, 2, 2}));
    EXPECT_EQ(field->min_m, (std::array<double, 3>{0, 0, 0}));
    EXPECT_EQ(field->cell_size_m, size);
  }
  EXPECT_THAT(to_dense(a), ElementsAre(0, 1, 2, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(to_dense(b), ElementsAre(0, 0, 8, 0, 0, 0, 0, 0, 0, 0, 16, 32, 0, 0, 0, 0));
  EXPECT_THAT(a.value, ElementsAre(1, 2, 4)) << "in the order of before";
}

// The second begins before the first along each axis.
TEST(JoinedFields, TheBoxMayBeginWithAnyOfThem) {
  CloudField a = low();
  CloudField b = make_cloud_field({2, 2, 2}, size, {-10, -20, -30}, {1, 0, 0, 0, 0, 0, 0, 2}, "");
  CloudField* const fields[]{&a, &b};
  share_box(fields);
  EXPECT_EQ(a.cells, (std::array<int, 3>{4, 3, 2}));
  EXPECT_EQ(a.min_m, (std::array<double, 3>{-10, -20, -30}));
  EXPECT_THAT(to_dense(a), ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  //
                                       0, 0, 0, 0, 0, 0, 1, 2, 0, 4, 0, 0));
  EXPECT_THAT(to_dense(b), ElementsAre(1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  //
                                       0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0));
}

TEST(JoinedFields, ValuesThatMeetAdd) {
  CloudField a = low(), b = high();
  CloudField* const fields[]{&a, &b};
  share_box(fields);
  const CloudField* const parts[]{&a, &b};
  const CloudField sum = sum_of(parts);
  EXPECT_THAT(to_dense(sum), ElementsAre(0, 1, 10, 0, 4, 0, 0, 0, 0, 0, 16, 32, 0, 0, 0, 0));
  EXPECT_EQ(sum.quantity, "extinction");
  EXPECT_THAT(places_in(sum, a), ElementsAre(0, 1, 2));
  EXPECT_THAT(places_in(sum, b), ElementsAre(1, 3, 4));
}

TEST(JoinedFields, OneFieldStaysAsItIs) {
  CloudField a = low();
  CloudField* const fields[]{&a};
  share_box(fields);
  EXPECT_EQ(a.cells, low().cells);
  const CloudField* const parts[]{&a};
  EXPECT_EQ(sum_of(parts).value, a.value);
}

TEST(JoinedFields, OtherVoxelsAreNamed) {
  EXPECT_FALSE(difference_of_voxels(low(), high()));
  CloudField shifted = high();
  shifted.min_m[1] += 20;
  EXPECT_FALSE(difference_of_voxels(low(), shifted)) << "by a whole voxel";
  shifted.min_m[1] += 5;
  EXPECT_THAT(*difference_of_voxels(low(), shifted), HasSubstr("along y voxels of 20 m with a face at 0 m"));
  EXPECT_THAT(*difference_of_voxels(low(), shifted), HasSubstr("of the other 20 m and 25 m"));
  CloudField longer = high();
  longer.cell_size_m[2] = 30.1;
  EXPECT_THAT(*difference_of_voxels(longer, low()), HasSubstr("along z voxels of 30.1 m"));
}

TEST(JoinedFields, FarFieldsAreRefused) {
  CloudField a = low(), b = high();
  b.min_m[1] = 20 * 1.9e9;
  b.min_m[2] = 30 * 1.9e9;
  CloudField* const fields[]{&a, &b};
  EXPECT_THROW(share_box(fields), InputError) << "3.6e18 rows";
}

}  // namespace
}  // namespace cloudbow
