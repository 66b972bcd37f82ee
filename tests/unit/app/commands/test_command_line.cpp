// The command line from arguments to exit code. Truth: the exit codes promised (0 done, 2 wrong input, 3 not
// converged).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/planning/tradeoff.hpp"
#include "call_cloudbow.hpp"
#include "cloudbow/app/command_line.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(CommandLine, HelpAndVersion) {
  EXPECT_THAT(cloudbow({"--help"}).output, AllOf(HasSubstr("run"), HasSubstr("sweep"), HasSubstr("cloud"),
                                                 HasSubstr("render"), HasSubstr("export")));
  EXPECT_THAT(cloudbow({"export", "--help"}).output,
              AllOf(HasSubstr("from the scene to the sensor"), HasSubstr("--zenith-deg"), HasSubstr("--actinic")));
  EXPECT_THAT(cloudbow({"run", "--help"}).output,
              AllOf(HasSubstr("--set"), HasSubstr("--dry-run"), HasSubstr("--threads")));
  EXPECT_THAT(cloudbow({"cloud", "make", "--help"}).output, AllOf(HasSubstr("--cells"), HasSubstr("stratocumulus")));
  const Outcome version = cloudbow({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.output,
              AllOf(HasSubstr("cloudbow 0."), HasSubstr("OpenVDB 1"), HasSubstr("HDF5 1."), HasSubstr("Eigen 3.")));
}

TEST(CommandLine, UsageErrors) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {},
           {"fly"},
           {"run"},
           {"run", "--fast", "scene.toml"},
           {"run", "scene.toml", "--threads", "0"},
           {"run", "scene.toml", "--threads", "two"},
           {"cloud"},
           {"cloud", "make", "slab", "--cells", "4", "4", "--voxel-size-m", "1", "1", "1", "-o", "x.vdb"},
           {"cloud", "make", "slab", "--cells", "4", "4", "-4", "--voxel-size-m", "1", "1", "1", "-o", "x.vdb"},
           {"cloud", "make", "slab", "--cells", "4", "4", "4", "--voxel-size-m", "1", "nan", "1", "-o", "x.vdb"},
           {"cloud", "make", "slab", "--cells", "4", "4", "4", "--voxel-size-m", "1", "1", "1", "--seed", "-1", "-o",
            "x.vdb"},
           {"cloud", "make", "cirrus", "--cells", "4", "4", "4", "--voxel-size-m", "1", "1", "1", "-o", "x.vdb"},
           {"render"},
           {"render", "x.h5", "-o", "x.png", "--exposure", "0"},
           {"render", "x.h5", "-o", "x.png", "--exposure", "bright"},
           {"render", "x.h5", "-o", "x.png", "--tone", "soft"},
           {"tradeoff"},
           {"tradeoff", "no-such-scene.toml"},
           {"tradeoff", "scene.toml", "--threads", "0"},
           {"tradeoff", "scene.toml", "--levels"},
           {"export"},
           {"export", "result.h5", "--vdb", "x.vdb"},
           {"export", "result.h5", "--vdb", "x.vdb", "--direction", "0", "1"},
           {"export", "result.h5", "--direction", "0", "0", "1"},
           {"mie", "--wavelength-um", "1"},
           {"mie", "--wavelength-um", "0", "--effective-radius-um", "5", "-o", "x.h5"},
           {"mie", "--wavelength-um", "1", "--effective-radius-um", "1e-300", "-o", "x.h5"},
           {"mie", "--wavelength-um", "1", "1:2:0.5", "--effective-radius-um", "5", "-o", "x.h5"},
           {"mie", "--wavelength-um", "1", "--effective-radius-um", "9:5:1", "-o", "x.h5"},
           {"mie", "--wavelength-um", "1", "--effective-radius-um", "5:9", "-o", "x.h5"},
           {"mie", "--wavelength-um", "2000", "--effective-radius-um", "5", "-o", "x.h5"},
           {"mie", "--wavelength-um", "1", "--effective-radius-um", "5", "--variance", "0.6", "-o", "x.h5"},
           {"mie", "--wavelength-um", "1", "--effective-radius-um", "5", "--refractive-index", "1.3", "-o", "x.h5"},
           {"mie", "--wavelength-um", "1", "--effective-radius-um", "5", "--substance", "milk", "-o", "x.h5"},
       }) {
    const Outcome outcome = cloudbow(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_EQ(outcome.output, "");
  }
}

TEST(CommandLine, RunsASlab) {
  const TemporaryFolder folder;
  const auto scene = folder.write("slab.toml", slab_toml);
  const auto result = folder / "result.h5";
  const Outcome outcome = cloudbow({"run", scene, "-o", result, "--threads", "1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_TRUE(std::filesystem::exists(result));
  EXPECT_THAT(outcome.errors, HasSubstr("columns"));
  const Outcome iterated = cloudbow({"run", scene, "-o", result, "--set", "solver.mode=3d"});
  EXPECT_EQ(iterated.exit_code, 0) << iterated.errors;
  EXPECT_THAT(iterated.errors, HasSubstr("sweep"));
  const Outcome quiet = cloudbow({"run", scene, "-o", result, "--quiet", "--set", "sun.zenith_deg=10"});
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.output + quiet.errors, "");
}

TEST(CommandLine, MessagesHoldNoControlCharacters) {
  const Outcome outcome = cloudbow({"cloud", "info", "none\x1b[2J.vdb"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("none\\x1b[2J.vdb"), testing::Not(HasSubstr("\x1b"))));
}

TEST(CommandLine, PlotsByOtherEndingsThanTheirKindAreRefused) {
  const TemporaryFolder folder;
  for (const std::string name : {"hg.jpg", "hg.eps", "hg.exr"}) {
    const Outcome outcome =
        cloudbow({"phase", "rayleigh", "--control-points", "42", "--plot", folder / name, "-o", folder / "hg.h5"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, AllOf(HasSubstr(name), HasSubstr("allowed .png, .svg, .pdf")));
    EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
  }
}

}  // namespace
}  // namespace cloudbow
