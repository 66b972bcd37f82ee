// Cost of columns without iteration. Truth: it is proportional to the work, and no less than the arrays that come out.
#include <gtest/gtest.h>

#include "transport/columns/columns.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem field_of(int columns) {
  Problem problem;
  const BoxGrid box = make_box(columns, columns, 10);
  std::vector<float> extinction(cells_of(box));  // columns differ
  for (std::size_t c = 0; c < extinction.size(); ++c) extinction[c] = 1 + .001F * static_cast<float>(c % box.columns());
  problem.grid = make_grid(box, extinction, .9);
  problem.phase = {PhaseFunction::isotropic()};
  problem.sun = Sun{travel_along(-.6, 20), 1.};
  return problem;
}

TEST(ColumnsCost, TimeIsProportionalToCellsAndSharedByThreads) {
  const Problem small = field_of(10), large = field_of(20);
  const SolverOptions options = coarse_options();
  const double seconds = columns_seconds(small, options, false, 1);
  EXPECT_GT(seconds, 0);
  EXPECT_NEAR(columns_seconds(large, options, false, 1) / seconds, 4, 1e-12);
  EXPECT_NEAR(columns_seconds(small, options, false, 2) / seconds, .5, 1e-12);
  EXPECT_GT(columns_seconds(small, options, true, 1), seconds);
  SolverOptions more = options;
  more.column_streams *= 2;
  EXPECT_GT(columns_seconds(small, more, false, 1), 4 * seconds) << "matrices of streams";
}

TEST(ColumnsCost, EqualColumnsCountOnceUnlessTheBeamCrossesThem) {
  Problem problem = field_of(10);
  const SolverOptions options = coarse_options();
  const double seconds = columns_seconds(problem, options, false, 1);
  problem.grid = make_grid(problem.grid.box, std::vector<float>(cells_of(problem.grid.box), 1.F), .9);
  EXPECT_NEAR(columns_seconds(problem, options, false, 1) / seconds, .01, 1e-12) << "of 100 columns";
  SolverOptions slanted = options;
  slanted.beam_crosses_columns = true;
  EXPECT_GT(columns_seconds(problem, slanted, false, 1), seconds);
}

TEST(ColumnsCost, MemoryHoldsTheGridAndTheFieldsThatComeOut) {
  const Problem problem = field_of(100);
  SolverOptions options = coarse_options();
  options.flux_levels = FluxLevels::all;
  const std::size_t cells = 100 * 100 * 10, fluxes = 3 * 11 * 100 * 100;
  const std::size_t fluxes_alone = columns_memory(problem, options, false, 1);
  EXPECT_GE(fluxes_alone, sizeof(float) * (2 * cells + fluxes));
  options.actinic = true;
  EXPECT_GE(columns_memory(problem, options, false, 1), fluxes_alone + sizeof(float) * cells);
  EXPECT_GT(columns_memory(problem, options, false, 8), columns_memory(problem, options, false, 1));
}

}  // namespace
}  // namespace cloudbow
