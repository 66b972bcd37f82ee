// Numbers of a line. Truth: the numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/number_rows.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(NumberRows, AreReadUpToACommentWhateverSeparatesThem) {
  EXPECT_THAT(numbers_in("1 2.5\t-3e2").value(), ElementsAre(1, 2.5, -300));
  EXPECT_THAT(numbers_in("1, 2,3 # 4").value(), ElementsAre(1, 2, 3));
  EXPECT_THAT(numbers_in("1.5D+01 ! Fortran").value(), ElementsAre(15));
  EXPECT_THAT(numbers_in("# nothing").value(), IsEmpty());
  EXPECT_THAT(numbers_in("").value(), IsEmpty());
}

TEST(NumberRows, WordsAndInfiniteNumbersAreNone) {
  for (const char* line : {"1 two", "nan", "inf 1", "1e999", "0x10 g"}) EXPECT_FALSE(numbers_in(line)) << line;
}

}  // namespace
}  // namespace cloudbow
