#include <gmock/gmock.h>

#include "../io/sample_solution.hpp"
#include "cloudbow/results/summary.hpp"

namespace cloudbow {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

TEST(SummaryTable, ShowsLedgerAndCost) {
  const std::string table = summary_table(sample::solution(2, 2, 2));
  EXPECT_THAT(table, HasSubstr("reflectance           0.500000\n"));
  EXPECT_THAT(table, HasSubstr("transmittance         0.375000   direct 0.125000\n"));
  EXPECT_THAT(table, HasSubstr("absorptance           0.062500\n"));
  EXPECT_THAT(table, HasSubstr("surface absorptance   0.031250\n"));
  EXPECT_THAT(table, HasSubstr("1.0e-07\n"));
  EXPECT_THAT(table, HasSubstr("5.0e-05   after 17 sweeps\n"));
  EXPECT_THAT(table, HasSubstr("12.50 s with 2 threads"));
  EXPECT_THAT(table, HasSubstr("6000.0 MB"));
  EXPECT_THAT(table, EndsWith("\nconverged\n"));
}

TEST(SummaryTable, ShowsFluxesOfScenesThatEmit) {
  const std::string table = summary_table(sample::thermal_solution(2, 2, 2), "W m-2 um-1");
  EXPECT_THAT(table, HasSubstr("flux up at the top           4 W m-2 um-1\n"));
  EXPECT_THAT(table, HasSubstr("flux down, ground            3 W m-2 um-1\n"));
  EXPECT_THAT(table, HasSubstr("net absorbed by air        0.5 W m-2 um-1\n"));
  EXPECT_THAT(table, HasSubstr("net absorbed, ground     -5.75 W m-2 um-1\n"));
  EXPECT_THAT(table, Not(HasSubstr("reflectance")));
  EXPECT_THAT(table, Not(HasSubstr("transmittance")));
}

TEST(SummaryTable, ShowsSidesOnlyWhereTheyAreOpen) {
  Solution solution = sample::solution(2, 2, 2);
  EXPECT_THAT(summary_table(solution), Not(HasSubstr("side")));
  solution.box.periodic = false;
  EXPECT_THAT(summary_table(solution), HasSubstr("side gain             0.250000\nside loss             0.281250\n"));
}

TEST(SummaryTable, SaysWhenTheSolveFailed) {
  Solution solution = sample::solution(2, 2, 2);
  solution.report.converged = false;
  EXPECT_THAT(summary_table(solution), HasSubstr("\nNOT CONVERGED"));
}

}  // namespace
}  // namespace cloudbow
