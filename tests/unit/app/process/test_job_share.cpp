#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/process/job_share.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

TEST(JobShare, EveryPieceBelongsToOneShare) {
  for (std::size_t piece = 0; piece < 10; ++piece) {
    int owners = 0;
    for (const char* text : {"1/3", "2/3", "3/3"}) owners += parse_job_share("--part", text).has(piece) ? 1 : 0;
    EXPECT_EQ(owners, 1) << piece;
  }
}

TEST(JobShare, OtherTextIsRefusedByTheNameOfItsOption) {
  for (const char* wrong : {"", "2", "0/2", "3/2", "1/0", "1/2/3", "a/b", "-1/2", "1/2 "}) {
    try {
      parse_job_share("--part", wrong);
      ADD_FAILURE() << wrong;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("--part: found '"));
    }
  }
}

}  // namespace
}  // namespace cloudbow
