// `cloudbow phase`. Truth: closed forms of the functions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

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
  // Without the seconds of each fit.
  const auto table = [](const std::string& length) {
    const Outcome outcome = cloudbow({"phase", "henyey-greenstein", "--asymmetry-parameter", "0.8", "--control-points",
                                      "42", "--fit", "least-squares", "--travel", length, length, length});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    return std::regex_replace(outcome.output, std::regex(R"( +\d+\.\d\d\n)"), "\n");
  };
  const std::string of_one = table("1");
  for (const char* length : {"1e300", "1e-300", "5e-324"}) EXPECT_EQ(table(length), of_one) << length;
}

}  // namespace
}  // namespace cloudbow
