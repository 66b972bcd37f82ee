// Meaning of a stored factor of this machine. Truth: the file as written here, and the prediction of the version that
// gave the header its number.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "app/planning/machine_speed.hpp"
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
  auto [problem, options] = calibration_solve();
  options.threads = 1;
  // If this number changes, raise that of machine_speed_header and write both here.
  EXPECT_STREQ(machine_speed_header, "cloudbow machine 2");
  EXPECT_NEAR(predict_seconds(SolvePlan(problem, options)), .52057, 1e-4);
}

}  // namespace
}  // namespace cloudbow
