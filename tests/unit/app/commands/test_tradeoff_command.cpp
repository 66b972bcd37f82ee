// `cloudbow tradeoff`. Truth: one message and exit code 2 before anything is solved.
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

using testing::HasSubstr;

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

}  // namespace
}  // namespace cloudbow
