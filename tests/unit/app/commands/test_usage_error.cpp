// Messages about words that are not known. Truth: the words that are.
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

TEST(CommandLine, WordsThatNobodyKnowsComeWithThoseThatAreKnown) {
  for (const auto& [arguments, told] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"rn", "scene.toml"},
            "cloudbow: unknown command (found rn, allowed run, merge, sweep, cloud, mie, gas, render, export, "},
           {{"rn", "scene.toml"}, "; did you mean run?)"},
           {{"info", "cloud.vdb"}, "; did you mean cloud info?)"},
           {{"cloud", "mke", "slab"},
            "cloud: unknown command (found mke, allowed make, import, info, refine; did you mean make?)"},
           {{"cloud"}, "cloud: no command (found none, allowed make, import, info, refine)"},
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

}  // namespace
}  // namespace cloudbow
