// Progress of runs. Truth: closed forms.
#include <gtest/gtest.h>

#include "app/process/progress.hpp"

namespace cloudbow {
namespace {

TEST(RunClock, TheRestTakesAsLongAsWhatIsDone) {
  EXPECT_DOUBLE_EQ(*RunClock::seconds_left(10, 0.25), 30);
  EXPECT_DOUBLE_EQ(*RunClock::seconds_left(10, 1), 0);
  EXPECT_DOUBLE_EQ(*RunClock::seconds_left(10, 1.5), 0);
  EXPECT_FALSE(RunClock::seconds_left(1, 0.25)) << "too early to tell";
  EXPECT_FALSE(RunClock::seconds_left(10, 0.001)) << "too little to tell";
  EXPECT_FALSE(RunClock(3).seconds_left(0.5)) << "just begun";
}

TEST(RunClock, TimesAreShort) {
  EXPECT_EQ(time_left_text(0.4), "0 s left");
  EXPECT_EQ(time_left_text(59.4), "59 s left");
  EXPECT_EQ(time_left_text(60), "1 min left");
  EXPECT_EQ(time_left_text(3569), "59 min left");
  EXPECT_EQ(time_left_text(3600), "1 h 0 min left");
  EXPECT_EQ(time_left_text(12000), "3 h 20 min left");
}

TEST(RunClock, PhasesFollowEachOther) {
  double before = 0;
  for (const char* phase : {"tables", "beam", "sweep", "gather"}) {
    EXPECT_DOUBLE_EQ(solve_fraction(phase, 0), before) << phase;
    before = solve_fraction(phase, 1);
  }
  EXPECT_EQ(before, 1);
  EXPECT_EQ(solve_fraction("droplets", 0.25), 0.25);
  EXPECT_EQ(solve_fraction("sweep", 7), solve_fraction("sweep", 1));
}

}  // namespace
}  // namespace cloudbow
