// `cloudbow mie`. Truth: the wavelengths and radii that the command line states.
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

}  // namespace
}  // namespace cloudbow
