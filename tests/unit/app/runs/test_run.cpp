// Runs from the command line. Truth: the exit codes promised (0 done, 2 wrong input, 3 not converged), and the same
// scene solved in another way.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>

#include "../commands/call_cloudbow.hpp"
#include "app/planning/tradeoff.hpp"
#include "cloudbow/app/command_line.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Truth: the same scene with the numbers of one wavelength in it.
TEST(CommandLine, ASpectrumIsItsWavelengths) {
  const TemporaryFolder folder;
  const std::string rest =
      "[[layer]]\nbottom_m = 0\ntop_m = 100\noptical_depth = 2\nsingle_scattering_albedo = 0.9\n"
      "phase_function = \"isotropic\"\n[sun]\nzenith_deg = 30\nazimuth_deg = 0\n[solver]\naccuracy = \"draft\"\n";
  const auto run = [&](const std::string& more) {
    const Outcome outcome = cloudbow({"run", folder.write("scene.toml", rest + more), "-o", folder / "r.h5"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    return lines_of(outcome.output, "reflectance");
  };
  const auto both = run("[spectrum]\nwavelengths_um = [0.67, 0.55]\n[surface]\nalbedo = [0.1, 0.6]\n");
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0], run("[surface]\nalbedo = 0.1\n").at(0));
  EXPECT_EQ(both[1], run("[surface]\nalbedo = 0.6\n").at(0));
  EXPECT_NE(both[0], both[1]);
}

TEST(CommandLine, RadianceFieldsOfASpectrumNeedTheSameCells) {
  const TemporaryFolder folder;
  const auto scene = folder.write(
      "scene.toml",
      "[spectrum]\nwavelengths_um = [0.67, 0.55]\n[[layer]]\nbottom_m = 0\ntop_m = 100\noptical_depth = [1, 0]\n"
      "single_scattering_albedo = 0.9\nphase_function = \"isotropic\"\n[sun]\nzenith_deg = 30\nazimuth_deg = 0\n"
      "[output]\nfields = [\"radiance_field\"]\n");
  const Outcome outcome = cloudbow({"run", scene, "--dry-run"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("same cells"), HasSubstr("0.55 um")));
}

TEST(CommandLine, CheckpointsOfColumnsWithoutIterationAreSaidToBeUnused) {
  const TemporaryFolder folder;
  const auto scene = folder.write("slab.toml", slab_toml);
  const std::vector<std::string> run{"run", scene, "-o", folder / "slab.h5", "--checkpoint", folder / "state.h5"};
  const Outcome columns = cloudbow(run);
  EXPECT_EQ(columns.exit_code, 0);
  EXPECT_THAT(columns.errors, HasSubstr("--checkpoint is not used"));
  EXPECT_FALSE(std::filesystem::exists(folder / "state.h5"));
  auto in_3d = run;
  for (const char* word : {"--set", "solver.mode=3d"}) in_3d.push_back(word);
  const Outcome iterated = cloudbow(in_3d);
  EXPECT_EQ(iterated.exit_code, 0) << iterated.errors;
  EXPECT_THAT(iterated.errors, testing::Not(HasSubstr("not used")));
  EXPECT_TRUE(std::filesystem::exists(folder / "state.h5"));
}

TEST(CommandLine, OneColumnIsItsOwnIndependentColumn) {
  const TemporaryFolder folder;
  const auto scene = folder.write("slab.toml", slab_toml);
  const auto result = folder / "result.h5";
  const Outcome outcome = cloudbow({"run", scene, "-o", result, "--compare"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("reflectance +0.000000, transmittance +0.000000"));
  const Outcome twice = cloudbow({"run", scene, "-o", result, "--compare", "--set", "solver.mode=independent-columns"});
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.errors, HasSubstr("solver.mode"));
}

TEST(CommandLine, DryRunWritesNothing) {
  const TemporaryFolder folder;
  const Outcome outcome =
      cloudbow({"run", folder.write("slab.toml", slab_toml), "-o", folder / "result.h5", "--dry-run"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("memory"), HasSubstr("time")));
  EXPECT_FALSE(std::filesystem::exists(folder / "result.h5"));
}

// 0.5 g/m3 of 10 um droplets over 100 m in one of four columns: 50 g/m2 and an optical depth of 7.5.
TEST(CommandLine, DryRunShowsWhatAWrongUnitWouldChange) {
  const TemporaryFolder folder;
  write_cloud_vdb(folder / "cloud.vdb",
                  make_cloud_field({2, 2, 1}, {50, 50, 100}, {0, 0, 400}, {0.5f, 0, 0, 0}, "liquid_water_content"));
  const auto scene =
      folder.write("scene.toml",
                   "[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"isotropic\"\nsingle_scattering_albedo = 1\n"
                   "effective_radius_um = 10\n[sun]\nzenith_deg = 30\nazimuth_deg = 0\n");
  const Outcome outcome = cloudbow({"run", scene, "--dry-run"});
  EXPECT_EQ(outcome.errors, "");
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("domain    0 to 100 m, 0 to 100 m, 400 to 500 m along x, y, z\n"),
                    HasSubstr("cloud     optical depth: mean of all columns 1.875, largest of a column 7.5\n"),
                    HasSubstr("water     path: mean of all columns 12.5 g/m2, largest of a column 50 g/m2"),
                    HasSubstr("radius    10 um\n")));
  const Outcome thousand = cloudbow({"run", scene, "--dry-run", "--set", "cloud.scale=1000"});
  EXPECT_EQ(thousand.exit_code, 0);
  EXPECT_THAT(thousand.errors, AllOf(HasSubstr("cloudbow: warning: "), HasSubstr("500 g/m3")));
}

// The same water, and ice of .917 g/m3 and 30 um beside it: 91.7 g/m2 and an optical depth of 5 in one of four columns.
TEST(CommandLine, DryRunShowsEachConstituent) {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& file, const std::vector<float>& dense, const std::string& quantity) {
    write_cloud_vdb(folder / file, make_cloud_field({2, 2, 1}, {50, 50, 100}, {0, 0, 400}, dense, quantity));
  };
  write("liquid.vdb", {0.5F, 0, 0, 0}, "liquid_water_content");
  write("ice.vdb", {0, 0.917F, 0, 0}, "ice_water_content");
  const auto constituent = [](const std::string& name, const std::string& radius) {
    return "[[cloud]]\nname = \"" + name + "\"\nfile = \"" + name +
           ".vdb\"\nphase_function = \"isotropic\"\nsingle_scattering_albedo = 1\neffective_radius_um = " + radius +
           "\n";
  };
  const Outcome outcome = cloudbow({"run",
                                    folder.write("scene.toml", constituent("liquid", "10") + constituent("ice", "30") +
                                                                   "[sun]\nzenith_deg = 30\nazimuth_deg = 0\n"),
                                    "--dry-run"});
  EXPECT_EQ(outcome.errors, "");
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("cloud     liquid: optical depth: mean of all columns 1.875, largest of a column 7.5\n"),
                    HasSubstr("water     liquid: path: mean of all columns 12.5 g/m2, largest of a column 50 g/m2"),
                    HasSubstr("radius    liquid: 10 um\n"),
                    HasSubstr("cloud     ice: optical depth: mean of all columns 1.25, largest of a column 5\n"),
                    HasSubstr("water     ice: path: mean of all columns 22.92 g/m2, largest of a column 91.7 g/m2"),
                    HasSubstr("radius    ice: 30 um\n")));
}

TEST(CommandLine, NotConvergedIsThreeAndStillWritten) {
  const TemporaryFolder folder;
  const Outcome outcome =
      cloudbow({"run", folder.write("slab.toml", slab_toml), "-o", folder / "result.h5", "--quiet", "--set",
                "solver.mode=3d", "--set", "solver.max_sweeps=1", "--set", "layer.0.optical_depth=50"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("not converged"));
  EXPECT_TRUE(std::filesystem::exists(folder / "result.h5"));
}

TEST(CommandLine, WrongInputIsTwoAndLeavesNoFile) {
  const TemporaryFolder folder;
  const auto scene = folder.write("slab.toml", slab_toml);
  const auto result = folder / "result.h5";
  for (const std::string wrong :
       {"sun.zenith_deg=95", "sun.zenith=1", "surface.albedo=1.2", "layer.0.single_scattering_albedo=1.01",
        "sun.zenith_deg=nan", "sun.bearing_deg=3", "solver.max_sweeps=0"}) {
    const Outcome outcome = cloudbow({"run", scene, "-o", result, "--set", wrong});
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_THAT(outcome.errors, HasSubstr(wrong.substr(0, wrong.find('='))));
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  }
  EXPECT_EQ(cloudbow({"run", folder / "none.toml", "-o", result}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(result));
  EXPECT_EQ(cloudbow({"run", scene, "-o", folder / "nowhere/result.h5"}).exit_code, 2);
  const Outcome itself = cloudbow({"run", scene, "-o", scene});
  EXPECT_EQ(itself.exit_code, 2);
  EXPECT_THAT(itself.errors, HasSubstr("overwrite"));
}

TEST(CommandLine, GoalsTellWhatIsWrongBeforeAnythingIsSolved) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("slab.toml", slab_toml);
  const auto result = folder / "result.h5";
  for (const auto& [arguments, told] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--target-error", "much"}, "'much'"},
           {{"--target-error", "0%"}, "above 0"},
           {{"--budget", "3 days"}, "'3 days'"},
           {{"--target-error", "1%", "--of", "clouds"}, "clouds"},
           {{"--target-error", "1%", "--dry-run"}, "--dry-run"},
           {{"--budget", "1m", "--compare"}, "--compare"},
           {{"--budget", "1m", "--set", "solver.accuracy=fine"}, "solver.accuracy=fine"},
           {{"--budget", "0.000001s"}, "too short"}}) {
    std::vector<std::string> all{"run", scene, "-o", result};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome outcome = cloudbow(all);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(all);
    EXPECT_THAT(outcome.errors, HasSubstr(told));
    EXPECT_FALSE(std::filesystem::exists(result));
  }
}

class Signals : public testing::TestWithParam<int> {};

TEST_P(Signals, EndARunBetweenSweepsAndLeaveNothing) {
  const TemporaryFolder folder;
  // Thick and conservative with a tolerance that takes many sweeps: still busy when the signal comes.
  const std::string scene = folder.write("slab.toml", slab_toml);
  const std::string result = folder / "result.h5";
  const std::string log = folder / "log";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    signal(GetParam(), SIG_DFL);  // whoever started the tests may have made it ignored
    const int file = open(log.c_str(), O_WRONLY | O_CREAT, 0600);
    dup2(file, STDERR_FILENO);
    const std::vector<const char*> argv{"cloudbow",
                                        "run",
                                        scene.c_str(),
                                        "-o",
                                        result.c_str(),
                                        "--threads",
                                        "1",
                                        "--set",
                                        "layer.0.optical_depth=2000",
                                        "--set",
                                        "layer.0.single_scattering_albedo=1",
                                        "--set",
                                        "solver.accuracy=fine",
                                        "--set",
                                        "solver.tolerance=1e-8",
                                        "--set",
                                        "domain.vertical_cells=20000"};
    std::_Exit(run_command_line(static_cast<int>(argv.size()), argv.data()));
  }
  // The first line of the log says that the solve has begun.
  for (int n = 0; n < 1000 && (!std::filesystem::exists(log) || std::filesystem::file_size(log) == 0); ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  kill(child, GetParam());
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + GetParam());
  std::filesystem::remove(log);
  EXPECT_FALSE(std::filesystem::exists(result));
}

INSTANTIATE_TEST_SUITE_P(CommandLine, Signals, testing::Values(SIGINT, SIGTERM));

}  // namespace
}  // namespace cloudbow
