// Checkpoints of a run. Truth: what is saved comes back to the bit, and only for the problem that it is of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "app/planning/run_checkpoints.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(RunCheckpoints, OfSeveralSolvesHaveFilesOfTheirOwn) {
  EXPECT_EQ(checkpoint_file("run.ck", 0, 1), "run.ck");
  EXPECT_EQ(checkpoint_file("run.ck", 0, 3), "run.ck.1");
  EXPECT_EQ(checkpoint_file("run.ck", 2, 3), "run.ck.3");
  EXPECT_EQ(checkpoint_file("", 2, 3), "");
}

class RunCheckpointsTest : public testing::Test {
 protected:
  RunOptions options(bool resume, double minutes = 10) const {
    RunOptions some;
    some.quiet = true;
    some.checkpoint = folder_ / "ck";
    some.checkpoint_minutes = minutes;
    if (resume) some.resume = folder_ / "ck";
    return some;
  }
  const TemporaryFolder folder_;
};

TEST_F(RunCheckpointsTest, WhatIsSavedIsFoundAgain) {
  std::vector<float> values{1, 2.5F, -3};
  RunCheckpoints first(options(false), 0, 1);
  EXPECT_FALSE(first.used());
  EXPECT_EQ(first.find({7, 8}), Checkpoints::Found::nothing);
  EXPECT_TRUE(first.used());
  const std::vector<StateArray> state{{"numbers", sizeof(float), values.size(), {values.data()}}};
  first.save({7, 8}, state);

  RunCheckpoints same(options(true), 0, 1);
  EXPECT_EQ(same.find({7, 8}), Checkpoints::Found::same_problem);
  std::vector<float> loaded(3);
  same.load({"numbers", sizeof(float), loaded.size(), {loaded.data()}});
  EXPECT_EQ(loaded, values);

  RunCheckpoints other(options(true), 0, 1);
  EXPECT_EQ(other.find({7, 9}), Checkpoints::Found::same_layout);
  RunCheckpoints foreign(options(true), 0, 1);
  EXPECT_THAT([&] { foreign.find({6, 8}); }, ThrowsMessage<InputError>(HasSubstr("other cells, directions")));
}

TEST_F(RunCheckpointsTest, TheFirstStartOfOneFileForBothBeginsFromNothing) {
  RunCheckpoints both(options(true), 0, 1);
  EXPECT_EQ(both.find({1, 2}), Checkpoints::Found::nothing);
  RunOptions resume_alone;
  resume_alone.resume = folder_ / "none";
  EXPECT_THROW(RunCheckpoints(resume_alone, 0, 1), InputError);
}

TEST_F(RunCheckpointsTest, AreDueWhenTheirTimeHasPassed) {
  EXPECT_TRUE(RunCheckpoints(options(false, 0), 0, 1).due());
  EXPECT_FALSE(RunCheckpoints(options(false, 1e6), 0, 1).due());
  EXPECT_FALSE(RunCheckpoints(RunOptions(), 0, 1).due()) << "nothing is kept";
}

TEST_F(RunCheckpointsTest, AFileThatCannotBeWrittenDoesNotEndTheRun) {
  RunOptions some;
  some.checkpoint = "/nowhere/ck";
  RunCheckpoints checkpoints(some, 0, 1);
  testing::internal::CaptureStderr();
  EXPECT_NO_THROW(checkpoints.save({1, 2}, {}));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("no checkpoint: /nowhere/ck"));
}

}  // namespace
}  // namespace cloudbow
