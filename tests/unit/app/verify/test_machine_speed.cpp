// Meaning of a stored factor of this machine. Truth: the file as written here, and the prediction of the version that
// gave the header its number.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "app/verify/machine_speed.hpp"
#include "cloudbow/transport/solver.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

TEST(MachineSpeed, FactorsOfOtherVersionsCountAsNone) {
  const TemporaryFolder folder;
  setenv("XDG_CACHE_HOME", (folder / "").c_str(), 1);
  const std::filesystem::path cache = std::filesystem::path(folder / "") / "cloudbow";
  std::filesystem::create_directories(cache);
  const auto with = [&](const std::string& text) {
    std::ofstream(cache / "machine-speed.txt") << text;
    return machine_slowness();
  };
  EXPECT_EQ(with(std::string(machine_speed_header) + "\n2.5\n"), 2.5);
  EXPECT_EQ(with("cloudbow machine 1\n2.5\n"), 1);
  EXPECT_EQ(with(std::string(machine_speed_header) + "\n1e9\n"), 1);
  unsetenv("XDG_CACHE_HOME");
}

TEST(MachineSpeed, TheHeaderHasANewNumberWhenPredictionsChange) {
  const auto [problem, options] = calibration_solve();
  // If this number changes, raise that of machine_speed_header and write both here.
  EXPECT_STREQ(machine_speed_header, "cloudbow machine 4");
  EXPECT_NEAR(predict_seconds(SolvePlan(problem, options)), .66601, 1e-4);
}

// Ten seconds of which two were for tables, on a processor shared with three other programs.
TEST(MachineSpeed, TimeInWhichOtherProgramsRanDoesNotCount) {
  SolverReport report;
  report.seconds_total = 10;
  report.seconds_tables = 2;
  report.cpu_seconds = 2.5;
  EXPECT_DOUBLE_EQ(undisturbed_seconds(report), 2);
  report.cpu_seconds = 10;
  EXPECT_DOUBLE_EQ(undisturbed_seconds(report), 8);
}

TEST(MachineSpeed, OneThreadIsMeasured) { EXPECT_EQ(calibration_solve().second.threads, 1); }

}  // namespace
}  // namespace cloudbow
