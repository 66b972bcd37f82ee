// Groups of a result that have attributes alone. Truth: the numbers of the solution.
#include <gtest/gtest.h>

#include "io/hdf5_handle.hpp"
#include "sample_solution.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

double number(const hdf5::Handle& file, const char* group, const char* name) {
  return hdf5::attribute_number(hdf5::open_group(file, group), name);
}

TEST(ResultGroups, SummaryHasFractionsAndLedgerTheirFluxes) {
  const TemporaryFolder folder;
  write_result(folder / "a.h5", sample::solution(2, 1, 2), sample::info());
  const hdf5::Handle file = hdf5::open_file(folder / "a.h5");
  EXPECT_EQ(number(file, "summary", "reflectance"), .5);
  EXPECT_EQ(number(file, "summary", "transmittance"), .375);
  EXPECT_EQ(number(file, "ledger", "power"), 8);
  EXPECT_EQ(number(file, "ledger", "upwelling_top"), 4);
  EXPECT_EQ(number(file, "ledger", "absorbed"), .5);
  EXPECT_EQ(number(file, "solver", "sweeps"), 17);
  EXPECT_EQ(number(file, "solver", "peak_memory_bytes"), 6e9);
  for (const char* absent : {"plan", "error_estimate", "spectral", "thermal", "cloud"})
    EXPECT_FALSE(hdf5::exists(file, absent)) << absent;
}

TEST(ResultGroups, ATargetIsReportedWithItsOutcome) {
  const TemporaryFolder folder;
  ResultInfo info = sample::info();
  info.target = TargetReport{.target_error = .01,
                             .of = "domain",
                             .budget_seconds = 30,
                             .accuracy = "fine",
                             .levels_solved = "draft, fine",
                             .predicted_error = .005,
                             .seconds_in_all = 21,
                             .met = false};
  write_result(folder / "a.h5", sample::solution(2, 1, 2), info);
  const hdf5::Handle file = hdf5::open_file(folder / "a.h5");
  EXPECT_EQ(number(file, "plan", "target_error"), .01);
  EXPECT_EQ(number(file, "plan", "budget_seconds"), 30);
  EXPECT_EQ(number(file, "plan", "predicted_error"), .005);
  EXPECT_EQ(number(file, "plan", "seconds_in_all"), 21);
  EXPECT_EQ(number(file, "plan", "met"), 0);
  EXPECT_EQ(hdf5::attribute_text(hdf5::open_group(file, "plan"), "levels_solved"), "draft, fine");
}

}  // namespace
}  // namespace cloudbow
