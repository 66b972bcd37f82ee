// When an iteration restarts and when it ends. Truth: sequences of steps made for it.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "transport/iteration/step_watch.hpp"

namespace cloudbow {
namespace {

constexpr double rounding = 1e-5;

void add(std::vector<double>& steps, int count, double factor) {
  for (int n = 0; n < count; ++n) steps.push_back(steps.empty() ? 1 : steps.back() * factor);
}

TEST(StepWatch, SlowConvergenceGoesOn) {
  std::vector<double> steps;
  for (int n = 0; n < 200; ++n) {
    add(steps, 1, .98);  // .85 in eight sweeps
    const StepWatch watch = StepWatch::of(steps, rounding);
    EXPECT_FALSE(watch.restarted || watch.stuck) << n;
  }
}

TEST(StepWatch, APassingRiseIsNoCause) {
  std::vector<double> steps;
  add(steps, 5, .3);
  add(steps, 1, 10);
  add(steps, 5, .3);
  EXPECT_FALSE(StepWatch::of(steps, rounding).restarted);
}

TEST(StepWatch, GrowthRestartsOnceThenEnds) {
  std::vector<double> steps;
  add(steps, 4, .3);
  for (int n = 1; n <= 2 * StepWatch::patience + 1; ++n) {
    add(steps, 1, 1.2);
    const StepWatch watch = StepWatch::of(steps, rounding);
    EXPECT_EQ(watch.restart_now, n == StepWatch::patience) << n;
    EXPECT_EQ(watch.restarted, n >= StepWatch::patience) << n;
    // The first step after the restart is the one that the next ones are compared with.
    EXPECT_EQ(watch.stuck, n > 2 * StepWatch::patience) << n;
  }
}

TEST(StepWatch, ConvergenceAfterARestartIsNotStuck) {
  std::vector<double> steps;
  add(steps, 4, .3);
  add(steps, StepWatch::patience, 1.2);
  add(steps, 30, .5);
  const StepWatch watch = StepWatch::of(steps, 0);
  EXPECT_TRUE(watch.restarted);
  EXPECT_TRUE(watch.diverges);
  EXPECT_FALSE(watch.stuck);
}

TEST(StepWatch, APlateauOfSmallStepsIsNoDivergence) {
  std::vector<double> steps;
  add(steps, 10, .5);
  add(steps, StepWatch::patience, 1.);
  const StepWatch watch = StepWatch::of(steps, rounding);
  EXPECT_TRUE(watch.restart_now);
  EXPECT_FALSE(watch.diverges);
}

TEST(StepWatch, RoundingIsNotWorthARestart) {
  std::vector<double> steps;
  add(steps, 20, .5);
  add(steps, StepWatch::patience, 1.);
  const StepWatch watch = StepWatch::of(steps, rounding);
  EXPECT_FALSE(watch.restarted);
  EXPECT_TRUE(watch.stuck);
}

TEST(StepWatch, ChangeOfTheProblemIsNoGrowth) {
  std::vector<double> steps{1e-1, 1e-2, 1e-3, 5e-1, 4e-1, 3e-1};
  for (double step = .2; steps.size() < 14; step *= .8) steps.push_back(step);
  EXPECT_TRUE(StepWatch::of(steps, 0).restarted);
  const StepWatch watch = StepWatch::of(steps, 0, 3, 3);
  EXPECT_FALSE(watch.restarted);
  EXPECT_DOUBLE_EQ(watch.least, steps.back());
  // A plateau after it is one.
  steps.insert(steps.end(), StepWatch::patience, steps.back());
  EXPECT_TRUE(StepWatch::of(steps, 0, 3, 3).restarted);
}

}  // namespace
}  // namespace cloudbow
