// Levels of accuracy that a trade-off leaves out. Truth: their memory and what they can do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/planning/tradeoff.hpp"
#include "cloudbow/app/command_line.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "commands/call_cloudbow.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(CommandLine, TradeoffLeavesOutWhatDoesNotFit) {
  const TemporaryFolder folder;
  TradeoffOptions options;
  options.scene = folder.write("slab.toml", slab_toml);
  options.memory_bytes = 1'000'000;  // more than the grid takes, less than any solve
  EXPECT_THAT([&] { tradeoff(options); },
              testing::ThrowsMessage<InputError>(
                  AllOf(HasSubstr("draft"), HasSubstr("reference"), HasSubstr("0.00 GB are available"))));
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

}  // namespace
}  // namespace cloudbow
