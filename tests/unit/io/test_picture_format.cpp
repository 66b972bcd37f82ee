// Kinds of pictures by the endings of names. Truth: the two kinds that there are.
#include <gtest/gtest.h>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/picture_format.hpp"

namespace cloudbow {
namespace {

TEST(PictureFormat, IsThatOfTheEndingInLettersOfAnySize) {
  EXPECT_EQ(picture_format("a.png", OutputKind::picture), PictureFormat::png);
  EXPECT_EQ(picture_format("a.PNG"), PictureFormat::png);
  EXPECT_EQ(picture_format("a.exr", OutputKind::picture), PictureFormat::exr);
  EXPECT_EQ(picture_format("A.Exr", OutputKind::picture), PictureFormat::exr);
}

TEST(PictureFormat, OtherEndingsAreRefused) {
  EXPECT_THROW(picture_format("a.jpg", OutputKind::picture), InputError);
  EXPECT_THROW(picture_format("a.exr", OutputKind::plot), InputError) << "plots have no linear light";
}

}  // namespace
}  // namespace cloudbow
