// Memory and time of a run. Truth: sums over wavelengths and solves.
#include <gtest/gtest.h>

#include "app/planning/coarse_solves.hpp"
#include "app/planning/cost_estimate.hpp"
#include "cloudbow/transport/solver.hpp"
#include "planning/layer_scene.hpp"
#include "usual_memory.hpp"

namespace cloudbow {
namespace {

const std::string without_estimate = "[output]\nerror_estimate = false\n";

CostEstimate cost_of(const std::vector<Scene>& scenes, bool compare = false) {
  CloudFiles files(scenes.size() > 1);
  return estimate_cost(scenes, memory, 1, compare, files);
}

// No folder of caches, so that no factor of this machine counts.
class CostEstimateTest : public testing::Test {
 protected:
  CostEstimateTest() { setenv("XDG_CACHE_HOME", "/nonexistent", 1); }
  ~CostEstimateTest() override { unsetenv("XDG_CACHE_HOME"); }
};

TEST_F(CostEstimateTest, OfOneSceneIsThatOfItsPlan) {
  const CostEstimate cost = cost_of(layer_scenes(without_estimate));
  ASSERT_TRUE(cost.only);
  EXPECT_EQ(cost.solve_seconds, std::vector{predict_seconds(cost.only->plan)});
  EXPECT_GT(cost.seconds, cost.solve_seconds.front()) << "what reads and writes";
  EXPECT_EQ(cost.memory, predict_memory(cost.only->plan));
  EXPECT_TRUE(cost.levels_m.empty());
}

TEST_F(CostEstimateTest, TheErrorEstimateAddsItsCoarseSolve) {
  const CostEstimate without = cost_of(layer_scenes(without_estimate)), with = cost_of(layer_scenes());
  const PlannedScene& planned = *with.only;
  EXPECT_EQ(planned.accuracy, "draft");
  EXPECT_DOUBLE_EQ(with.seconds, without.seconds + predict_coarse_seconds(planned.plan, planned.coarse(), planned.as));
  EXPECT_GE(with.memory, without.memory);
}

TEST_F(CostEstimateTest, OfASpectrumIsTheSumOfItsWavelengths) {
  const std::string spectrum = without_estimate + "[spectrum]\nwavelengths_um = [0.5, 0.6, 0.7]\n";
  const CostEstimate one = cost_of(layer_scenes(without_estimate)), three = cost_of(layer_scenes(spectrum));
  EXPECT_EQ(three.solve_seconds, std::vector<double>(3, one.solve_seconds.front()));
  EXPECT_GT(three.seconds, 3 * one.solve_seconds.front());
  EXPECT_GT(three.memory, one.memory) << "results of all are kept";
  EXPECT_FALSE(three.only);
  EXPECT_FALSE(three.levels_m.empty());
}

TEST_F(CostEstimateTest, IndependentColumnsAskForFluxesAlone) {
  SolverOptions options;
  options.actinic = options.absorption = options.beam_crosses_columns = true;
  const SolverOptions columns = with_independent_columns(options);
  EXPECT_TRUE(columns.independent_columns);
  EXPECT_FALSE(columns.actinic);
  EXPECT_FALSE(columns.absorption);
  EXPECT_FALSE(columns.beam_crosses_columns);
  EXPECT_GT(cost_of(layer_scenes(without_estimate), true).seconds, cost_of(layer_scenes(without_estimate)).seconds);
}

TEST(CostEstimate, SmallRunsHaveDigitsToo) {
  EXPECT_EQ(memory_text(68'432'000), "0.0684 GB");
  EXPECT_EQ(memory_text(12'345'000'000), "12.3 GB");
  EXPECT_EQ(time_text(.0412), "0.041 s");
  EXPECT_EQ(time_text(9.94), "9.9 s");
  EXPECT_EQ(time_text(123.4), "123 s");
}

TEST(CostEstimate, GPointsByColumnsAreSolvedAsIndependentColumns) {
  Scene scene;
  EXPECT_EQ(as_solved(scene).solver.mode, SolveMode::automatic);
  scene.broadband.emplace();
  EXPECT_EQ(as_solved(scene).solver.mode, SolveMode::automatic);
  scene.broadband->method = SceneBroadband::Method::columns;
  EXPECT_EQ(as_solved(scene).solver.mode, SolveMode::independent_columns);
}

}  // namespace
}  // namespace cloudbow
