// Progress of runs. Truth: closed forms; on a stderr that is no terminal, a line for each sweep and for each other
// phase.
#include <gtest/gtest.h>

#include "app/process/progress.hpp"

namespace cloudbow {
namespace {

SolverProgress of_phase(const std::string& phase, int sweep = 0) {
  SolverProgress progress;
  progress.phase = phase;
  progress.sweep = sweep;
  progress.estimated_error = .25;
  progress.energy_residual = .125;
  return progress;
}

using Seconds = std::chrono::duration<double>;

// A solve of 1 s before 10 sweeps of 2 s, and 9 s after them; 10 s of coarse solves follow.
constexpr SolveSeconds phases{1, 2, 10, 9};

// Progress of it on a clock that begins at 0.
struct ShownRun {
  RunClock clock;
  RunClock::Time start{};

  explicit ShownRun(std::vector<double> solves) : clock(std::move(solves)) { clock.begin_solve(phases); }
  std::optional<double> left(double seconds, const SolverProgress& progress, double fraction) {
    return clock.seconds_left(progress, fraction,
                              start + std::chrono::duration_cast<RunClock::Time::duration>(Seconds(seconds)));
  }
};

TEST(RunClock, TheRestGoesAtThePaceOfTheSweeps) {
  ShownRun run({40});
  EXPECT_FALSE(run.left(0, of_phase("tables"), 0));
  EXPECT_FALSE(run.left(50, of_phase("beam"), 0)) << "nothing is measured";
  // 3 s of prediction took 6 s: 39 s of ten sweeps and what follows take 78 s.
  EXPECT_NEAR(*run.left(56, of_phase("sweep", 1), 0), 78, 1e-9);
  EXPECT_NEAR(*run.left(77, of_phase("sweep", 4), .5), 3 * (10 + 9 + 10), 1e-9);
}

TEST(RunClock, MoreSweepsThanPredictedCountByTheWayToTheTolerance) {
  ShownRun run({40});
  run.left(0, of_phase("beam"), 0);
  EXPECT_NEAR(*run.left(41, of_phase("sweep", 20), .75), .25 * 20 * 2 + 9 + 10, 1e-9);
  EXPECT_NEAR(*run.left(41, of_phase("sweep", 20), 1), 9 + 10, 1e-9);
  EXPECT_NEAR(*run.left(45.5, of_phase("gather", 20), .5), 4.5 + 10, 1e-9);
}

TEST(RunClock, OtherSolvesFollowWithTheirPredictedTimes) {
  ShownRun run({40, 80, 20});
  run.left(0, of_phase("beam"), 0);
  EXPECT_NEAR(*run.left(3, of_phase("sweep", 1), 0), 39 + 80 + 20, 1e-9);
  run.clock.finish_solve();
  run.clock.begin_solve(phases);
  // 40 s of prediction took 80 s.
  EXPECT_NEAR(*run.left(80, of_phase("tables"), 0), 2 * (80 + 20), 1e-9);
}

TEST(RunClock, WithoutPhasesTheRestTakesAsLongAsWhatIsDone) {
  RunClock clock({1});
  const RunClock::Time start{};
  EXPECT_FALSE(clock.seconds_left(of_phase("mie"), 0, start));
  EXPECT_FALSE(clock.seconds_left(of_phase("mie"), .25, start + std::chrono::seconds(1))) << "too early to tell";
  EXPECT_FALSE(clock.seconds_left(of_phase("mie"), .001, start + std::chrono::seconds(10))) << "too little to tell";
  EXPECT_DOUBLE_EQ(*clock.seconds_left(of_phase("mie"), .25, start + std::chrono::seconds(10)), 30);
  EXPECT_DOUBLE_EQ(*clock.seconds_left(of_phase("mie"), 1.5, start + std::chrono::seconds(10)), 0);
}

TEST(RunClock, TimesAreShort) {
  EXPECT_EQ(time_left_text(0.4), "0 s left");
  EXPECT_EQ(time_left_text(59.4), "59 s left");
  EXPECT_EQ(time_left_text(60), "1 min left");
  EXPECT_EQ(time_left_text(3569), "59 min left");
  EXPECT_EQ(time_left_text(3600), "1 h 0 min left");
  EXPECT_EQ(time_left_text(12000), "3 h 20 min left");
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
