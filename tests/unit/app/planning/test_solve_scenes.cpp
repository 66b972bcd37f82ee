// The solves of a run. Truth: each scene solved by itself.
#include <gtest/gtest.h>

#include "app/planning/solve_scenes.hpp"
#include "cloudbow/transport/solver.hpp"
#include "planning/layer_scene.hpp"
#include "usual_memory.hpp"

namespace cloudbow {
namespace {

Solved solved(const std::vector<Scene>& scenes, bool compare = false) {
  CloudFiles files(scenes.size() > 1);
  RunOptions options;
  options.quiet = true;
  options.threads = 1;
  options.compare = compare;
  return solve_all(scenes, estimate_cost(scenes, memory, 1, compare, files), options, memory, files);
}

TEST(SolveScenes, WavelengthsAreThoseSolvedAlone) {
  const std::string more = "[output]\nerror_estimate = false\n[surface]\nalbedo = ";
  const Solved both = solved(layer_scenes(more + "[0.1, 0.6]\n[spectrum]\nwavelengths_um = [0.5, 0.6]\n"));
  ASSERT_EQ(both.solutions.size(), 2U);
  EXPECT_TRUE(both.errors.empty());
  EXPECT_TRUE(both.independent_columns.empty());
  EXPECT_EQ(both.solutions[0].upwelling_flux, solved(layer_scenes(more + "0.1\n")).solutions[0].upwelling_flux);
  EXPECT_EQ(both.solutions[1].upwelling_flux, solved(layer_scenes(more + "0.6\n")).solutions[0].upwelling_flux);
}

TEST(SolveScenes, ErrorsAreEstimatedIfTheSceneAsksForThem) {
  const Solved with = solved(layer_scenes());
  ASSERT_EQ(with.errors.size(), 1U);
  EXPECT_EQ(with.errors[0].calibrated_for, "draft");
  EXPECT_GT(with.errors[0].domain.total(), 0);
}

TEST(SolveScenes, OneColumnIsItsOwnIndependentColumn) {
  const Solved with = solved(layer_scenes(), true);
  ASSERT_EQ(with.independent_columns.size(), 1U);
  EXPECT_EQ(with.independent_columns[0].upwelling_flux, with.solutions[0].upwelling_flux);
}

}  // namespace
}  // namespace cloudbow
