// `cloudbow cloud import`. Truth: the numbers of the text, and exit code 2 with one message.
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

}  // namespace
}  // namespace cloudbow
