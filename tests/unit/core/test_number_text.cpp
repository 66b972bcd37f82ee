// Truth: numbers as Fortran, C and Python write them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cloudbow/core/number_text.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;

TEST(NumberText, WordsStandBetweenBlanksAndCommas) {
  EXPECT_THAT(split_words(" 1,2 ,\t3\r"), ElementsAre("1", "2", "3"));
  EXPECT_THAT(split_words(" \t,"), ElementsAre());
  EXPECT_THAT(split_words("a"), ElementsAre("a"));
}

TEST(NumberText, ANumberIsTheWholeWord) {
  EXPECT_EQ(number_in("1.5"), 1.5);
  EXPECT_EQ(number_in("-.5"), -.5);
  EXPECT_EQ(number_in("+2"), 2);
  EXPECT_EQ(number_in("1.0D-1"), .1);
  EXPECT_EQ(number_in("-1.5d+01"), -15);
  EXPECT_EQ(number_in("1e3"), 1e3);
  EXPECT_TRUE(std::isnan(number_in("nan").value_or(0)));
  EXPECT_TRUE(std::isinf(number_in("-inf").value_or(0)));
  for (const char* word : {"", "+", "-", "+-1", "++1", "D5", "1.5um", "1D", "1D2D3", "0x10", "1e999", "one", "1 "})
    EXPECT_FALSE(number_in(word).has_value()) << word;
}

}  // namespace
}  // namespace cloudbow
