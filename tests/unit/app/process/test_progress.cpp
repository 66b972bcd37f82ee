// Progress of runs. Truth: closed forms; on a stderr that is no terminal, a line for each sweep and for each other
// phase.
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

SolverProgress of_phase(const std::string& phase, int sweep = 0) {
  SolverProgress progress;
  progress.phase = phase;
  progress.sweep = sweep;
  progress.estimated_error = .25;
  progress.energy_residual = .125;
  return progress;
}

std::string shown(bool quiet) {
  testing::internal::CaptureStderr();
  {
    ProgressDisplay display(quiet, 1e-3);
    for (const SolverProgress& progress :
         {of_phase("tables"), of_phase("tables"), of_phase("sweep", 1), of_phase("sweep", 2), of_phase("gather")})
      display.show(progress);
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Progress, HasALineForEachSweepAndPhase) {
  EXPECT_EQ(shown(false),
            "tables\nsweep 1: estimated error 2.50e-01, energy residual 1.25e-01\n"
            "sweep 2: estimated error 2.50e-01, energy residual 1.25e-01\ngather\n");
}

TEST(Progress, IsNoneIfQuiet) { EXPECT_EQ(shown(true), ""); }

}  // namespace
}  // namespace cloudbow
