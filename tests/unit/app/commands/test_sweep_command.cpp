// `cloudbow sweep` as a user calls it. Truth: the values on the command line. Its results are tested in
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

TEST(SweepCommand, EndsWithAFileAndNoParts) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.toml", slab_toml), out = folder / "out.h5";
  const Outcome done = cloudbow({"sweep", scene, "--set", "sun.zenith_deg=0:80:40", "--jobs", "2", "-o", out});
  EXPECT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_THAT(done.output, HasSubstr("3 runs written"));
  EXPECT_THAT(done.errors, HasSubstr("3 of 3: sun.zenith_deg="));
  EXPECT_TRUE(std::filesystem::exists(out));
  EXPECT_FALSE(std::filesystem::exists(out + ".parts"));
}

TEST(SweepCommand, UsageErrors) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.toml", slab_toml), out = folder / "out.h5";
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"sweep"},
           {"sweep", scene, "-o", out},
           {"sweep", scene, "--set", "sun.zenith_deg=0,1"},
           {"sweep", scene, "--set", "sun.zenith_deg=0,1", "-o", scene},
           {"sweep", scene, "--set", "sun.zenith_deg=0,1", "-o", out, "--jobs", "0"},
           {"sweep", scene, "--set", "sun.zenith_deg=0,1", "-o", out, "--share", "3/2"},
           {"sweep", scene, "--set", "sun.zenith_deg=0:10", "-o", out},
           {"sweep", scene, "--set", "sun.zenith_deg=0,,10", "-o", out}}) {
    const Outcome outcome = cloudbow(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace cloudbow
