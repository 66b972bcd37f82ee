// The command line from arguments to exit code. Truth: the exit codes promised (0 done, 2 wrong input, 3 not
// converged).
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <sstream>
#include <thread>

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

const std::string slab_toml = R"([[layer]]
bottom_m = 0
top_m = 100
optical_depth = 1
single_scattering_albedo = 0.9
phase_function = "rayleigh"
[sun]
zenith_deg = 60
azimuth_deg = 0
[solver]
accuracy = "draft"
)";

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

TEST(CommandLine, ImportsACloudWithItsPhaseFunctions) {
  const TemporaryFolder folder;
  const auto cells = folder.write("cells.csv",
                                  "# shape nx,ny,nz=2,2,3, dx=0.05 km, dy=0.05 km\n# z levels km: 0.1 0.2 0.3\n"
                                  "i,j,k,extinction_per_km,ssa,iphase\n0,0,1,10,0.9,1\n1,1,1,20,0.8,2\n");
  const auto moments = folder.write("moments.csv", "l,a,b\n0,1,1\n1,1.5,1.2\n2,1.25,0.5\n");
  const auto vdb = folder / "cloud.vdb", png = folder / "cloud.png";
  const Outcome outcome = cloudbow({"cloud", "import", cells, "--phase-functions", moments, "-o", vdb});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("moments with the factor 2l+1"), HasSubstr("2 x 2 x 3 of 50 x 50 x 100 m"),
                    HasSubstr("grid \"phase_index\""), HasSubstr("optical depth: min 1, mean 1.5, max 2")));
  const auto scene = folder.write("scene.toml",
                                  "[cloud]\nfile = \"cloud.vdb\"\nphase_function = \"d\"\n"
                                  "single_scattering_albedo_grid = \"single_scattering_albedo\"\n[phase_function.d]\n"
                                  "type = \"set\"\nfile = \"cloud.phase.csv\"\n[sun]\nzenith_deg = 0\nazimuth_deg = 0\n"
                                  "[solver]\nclass_tolerance = 0\n");
  EXPECT_THAT(cloudbow({"run", scene, "--dry-run"}).output, HasSubstr("2 of 2 functions"));
  EXPECT_EQ(cloudbow({"cloud", "info", vdb, "--plot", png}).exit_code, 0);
  EXPECT_GT(std::filesystem::file_size(png), 1000U);

  for (const auto& wrong : std::vector<std::vector<std::string>>{
           {"cloud", "import", folder / "none.nc", "-o", folder / "x.vdb"},
           {"cloud", "import", cells, "--phase-functions", folder / "none.csv", "-o", folder / "x.vdb"},
           {"cloud", "import", cells, "--voxel-size-m", "1", "2", "-o", folder / "x.vdb"},
           {"cloud", "import", cells, "--format", "grib", "-o", folder / "x.vdb"},
           {"cloud", "import", cells, "-o", cells},
           {"cloud", "import", cells, "-o", folder / "nowhere" / "x.vdb"},
           {"cloud", "info", vdb, "--plot", vdb}}) {
    const Outcome error = cloudbow(wrong);
    EXPECT_EQ(error.exit_code, 2) << testing::PrintToString(wrong);
    EXPECT_EQ(std::count(error.errors.begin(), error.errors.end(), '\n'), 1) << error.errors;
    EXPECT_FALSE(std::filesystem::exists(folder / "x.vdb"));
  }
}

/// Text that a run printed on lines that begin with a word.
std::vector<std::string> lines_of(const std::string& text, const std::string& word) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(word)) lines.push_back(line);
  }
  return lines;
}

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

TEST(CommandLine, MakesAMieTableThatAppearsWhole) {
  const TemporaryFolder folder;
  const auto table = folder / "drops.h5";
  const Outcome outcome =
      cloudbow({"mie", "--wavelength-um", "3.7", "--effective-radius-um", "4:8:2", "-o", table, "--threads", "1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, testing::AllOf(HasSubstr("Segelstein"), HasSubstr("\n         8 ")));
  EXPECT_EQ(read_droplet_table(table).effective_radius_um, (std::vector<double>{4, 6, 8}));
  EXPECT_EQ(cloudbow({"mie", "--wavelength-um", "3:4:0.5", "10", "--effective-radius-um", "4", "-o", table}).exit_code,
            0);
  EXPECT_EQ(read_droplet_table(table, 3.5).wavelength_um, 3.5);
  EXPECT_EQ(read_droplet_table(table, 10).wavelength_um, 10);
  EXPECT_EQ(cloudbow({"mie", "--wavelength-um", "3.7", "--effective-radius-um", "4", "-o", folder / "no" / "drops.h5"})
                .exit_code,
            2);
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

TEST(CommandLine, CloudInfoDoubtsAndRefuses) {
  const TemporaryFolder folder;
  const CloudField field = make_cloud_field({1, 1, 1}, {50, 50, 100}, {0, 0, 0}, {2005}, "liquid_water_content");
  write_cloud_vdb(folder / "cloud.vdb", field, {}, {{"reff", "effective_radius", "um", {1e-5f}}});
  const Outcome outcome = cloudbow({"cloud", "info", folder / "cloud.vdb"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("liquid water path"));
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("warning: "), HasSubstr("2005 g/m3"), HasSubstr("0.1 to 5000 um")));
}

TEST(CommandLine, MessagesHoldNoControlCharacters) {
  const Outcome outcome = cloudbow({"cloud", "info", "none\x1b[2J.vdb"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("none\\x1b[2J.vdb"), testing::Not(HasSubstr("\x1b"))));
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

TEST(CommandLine, TradeoffTellsWhatIsWrongBeforeItSolves) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("slab.toml", slab_toml);
  const auto csv = folder / "table.csv";
  for (const auto& [arguments, told] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--levels", "draft"}, "two or more"},
           {{"--levels", "draft,best"}, "'best'"},
           {{"--levels", "draft", "--reference", folder / "none.h5"}, "none.h5"},
           {{"--reference", scene}, "slab.toml"},
           {{"--set", "solver.accuracy=fine"}, "--levels"},
           {{"--set", "sun.zenith_deg=95"}, "zenith_deg"},
           {{"--set", "output.flux_levels=[50]"}, "flux_levels"},
           {{"--plot", folder / "nowhere" / "plot.png"}, "nowhere"},
           {{"--plot", folder / "plot.eps"}, "found .eps, allowed .png, .svg, .pdf"},
           {{"--csv", scene}, "overwrite"}}) {
    std::vector<std::string> all{"tradeoff", scene, "--csv", csv};
    if (arguments[0] == "--csv") all.resize(2);
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome outcome = cloudbow(all);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(all);
    EXPECT_THAT(outcome.errors, HasSubstr(told));
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_EQ(outcome.output, "");
    EXPECT_FALSE(std::filesystem::exists(csv));
  }
}

TEST(CommandLine, TradeoffLeavesOutWhatDoesNotFit) {
  const TemporaryFolder folder;
  TradeoffOptions options;
  options.scene = folder.write("slab.toml", slab_toml);
  options.memory_bytes = 1'000'000;  // more than the grid takes, less than any solve
  EXPECT_THAT([&] { tradeoff(options); },
              testing::ThrowsMessage<InputError>(
                  AllOf(HasSubstr("draft"), HasSubstr("reference"), HasSubstr("there are 0.00 GB"))));
}

// Columns under a slanted beam give no image.
TEST(CommandLine, TradeoffLeavesOutWhatCannotDoTheScene) {
  const TemporaryFolder folder;
  ASSERT_EQ(cloudbow({"cloud", "make", "sphere", "--cells", "4", "4", "4", "--voxel-size-m", "50", "50", "50", "-o",
                      folder / "sphere.vdb"})
                .exit_code,
            0);
  const std::string scene =
      folder.write("scene.toml",
                   "[cloud]\nfile = \"sphere.vdb\"\nsingle_scattering_albedo = 1\nphase_function = "
                   "\"isotropic\"\n[sun]\nzenith_deg = 30\nazimuth_deg = 0\n[[radiance]]\nname = \"nadir\"\n"
                   "zenith_deg = 0\n");
  TradeoffOptions options;
  options.scene = scene;
  options.memory_bytes = 1'000'000;  // so that nothing is solved, and all levels are listed
  EXPECT_THAT([&] { tradeoff(options); },
              testing::ThrowsMessage<InputError>(AllOf(HasSubstr("independent-columns left out: needs"),
                                                       HasSubstr("independent-diffuse left out: /"),
                                                       HasSubstr("[[radiance]]"), HasSubstr("draft"))));
  const Outcome asked = cloudbow({"tradeoff", scene, "--levels", "independent-diffuse,draft"});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.errors, AllOf(HasSubstr("independent-diffuse"), HasSubstr("[[radiance]]")));
}

TEST(CommandLine, WordsThatNobodyKnowsComeWithThoseThatAreKnown) {
  for (const auto& [arguments, told] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"rn", "scene.toml"},
            "cloudbow: unknown command (found rn, allowed run, sweep, cloud, mie, gas, render, export, "},
           {{"rn", "scene.toml"}, "; did you mean run?)"},
           {{"info", "cloud.vdb"}, "; did you mean cloud info?)"},
           {{"cloud", "mke", "slab"},
            "cloud: unknown command (found mke, allowed make, import, info; did you mean make?)"},
           {{"cloud"}, "cloud: no command (found none, allowed make, import, info)"},
           {{}, "no command (found none, allowed run, "},
           {{"--verison"}, "unknown option (found --verison, allowed --help, --version; did you mean --version?)"},
           {{"run", "scene.toml", "--dryrun"},
            "run: unknown option (found --dryrun, allowed --help, --output, --set, "},
           {{"run", "scene.toml", "--dryrun"}, "; did you mean --dry-run?)"},
           {{"run", "scene.toml", "--out=r.h5"}, "(found --out, "},
           {{"render", "r.h5", "--outptu", "r.png"}, "; did you mean --output?)"},
           {{"cloud", "info", "cloud.vdb", "--polt", "x.png"}, "cloud info: unknown option (found --polt, "},
           {{"run", "scene.toml", "other.toml"}, "run: a word too many (found other.toml)"},
           {{"run"}, "scene is required"}}) {
    const Outcome outcome = cloudbow(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(outcome.errors, HasSubstr(told));
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  }
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

TEST(CommandLine, DescribesAPhaseFunction) {
  const TemporaryFolder folder;
  const std::string plot = (folder / "hg.png").string(), file = (folder / "hg.h5").string();
  const Outcome outcome =
      cloudbow({"phase", "henyey-greenstein", "--asymmetry-parameter", "0.8", "--control-points", "42",
                "--delta-m-order", "6", "--fit", "least-squares,linear-programming", "--plot", plot, "-o", file});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("f = 0.262144"), HasSubstr("least-squares"), HasSubstr("0.64000")));
  EXPECT_THAT(outcome.output, testing::Not(HasSubstr("collocation")));
  EXPECT_TRUE(std::filesystem::exists(plot));
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST(CommandLine, OnlyTheDirectionOfTravelCounts) {
  const auto table = [](const std::string& length) {
    return cloudbow({"phase", "henyey-greenstein", "--asymmetry-parameter", "0.8", "--control-points", "42", "--fit",
                     "least-squares", "--travel", length, length, length});
  };
  const Outcome of_one = table("1");
  EXPECT_EQ(of_one.exit_code, 0) << of_one.errors;
  for (const char* length : {"1e300", "1e-300", "5e-324"}) EXPECT_EQ(table(length).output, of_one.output) << length;
}

TEST(CommandLine, MakesAndDescribesAndSolvesACloud) {
  const TemporaryFolder folder;
  const auto cloud = folder / "sphere.vdb";
  ASSERT_EQ(
      cloudbow({"cloud", "make", "sphere", "--cells", "6", "6", "6", "--voxel-size-m", "50", "50", "50", "-o", cloud})
          .exit_code,
      0);
  EXPECT_THAT(cloudbow({"cloud", "info", cloud}).output, HasSubstr("density"));
  EXPECT_EQ(cloudbow({"cloud", "info", folder / "none.vdb"}).exit_code, 2);
  const auto scene =
      folder.write("scene.toml",
                   "[cloud]\nfile = \"sphere.vdb\"\nsingle_scattering_albedo = 1\nphase_function = "
                   "\"isotropic\"\n[sun]\nzenith_deg = 0\nazimuth_deg = 0\n[solver]\naccuracy = \"draft\"\n");
  EXPECT_EQ(cloudbow({"run", scene, "-o", folder / "result.h5", "--quiet"}).exit_code, 0);
  EXPECT_EQ(cloudbow({"render", folder / "result.h5", "-o", folder / "picture.png"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "picture.png"));
  for (const std::vector<std::string>& how :
       std::vector<std::vector<std::string>>{{"--section", "y=100", "--title", "A section"},
                                             {"--profile"},
                                             {"--profile", "--variable", "direct_flux", "--size", "600"},
                                             {"--bare"},
                                             {"--min", "0", "--max", "1", "--colormap", "cividis"}}) {
    std::vector<std::string> all{"render", folder / "result.h5", "-o", folder / "another.png"};
    all.insert(all.end(), how.begin(), how.end());
    EXPECT_EQ(cloudbow(all).exit_code, 0) << testing::PrintToString(how);
    EXPECT_TRUE(std::filesystem::remove(folder / "another.png"));
  }
  EXPECT_EQ(cloudbow({"render", folder / "result.h5", "-o", folder / "other.png", "--variable", "nothing"}).exit_code,
            2);
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
