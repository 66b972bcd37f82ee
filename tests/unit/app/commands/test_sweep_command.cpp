// `cloudbow sweep` as a user calls it. Truth: the values on the command line. What it computes is in
// runs/test_sweep.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "call_cloudbow.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

TEST(SweepCommand, SolvesEachValueIntoOneFile) {
  const TemporaryFolder folder;
  const std::string result = folder / "suns.h5";
  const Outcome outcome =
      cloudbow({"sweep", folder.write("slab.toml", slab_toml), "--set", "sun.zenith_deg=0:60:30", "-o", result});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("3 runs written to " + result));
  EXPECT_TRUE(std::filesystem::exists(result));
  EXPECT_FALSE(std::filesystem::exists(result + ".parts"));
}

TEST(SweepCommand, RefusesWrongListsBeforeItSolves) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("slab.toml", slab_toml);
  for (const std::string wrong : {"sun.zenith_deg=60", "sun.zenith_deg=0:60:0", "sun.zenith_deg=0,95"}) {
    const Outcome outcome = cloudbow({"sweep", scene, "--set", wrong, "-o", folder / "suns.h5"});
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_FALSE(std::filesystem::exists(folder / "suns.h5"));
  }
}

}  // namespace
}  // namespace cloudbow
