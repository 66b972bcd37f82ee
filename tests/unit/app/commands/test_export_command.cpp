// `cloudbow export`. Truth: the fields that the command line names, and exit code 2 with one message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "call_cloudbow.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(ExportCommand, WritesTheGridsThatAreNamed) {
  const TemporaryFolder folder;
  const auto scene = folder.write("slab.toml", slab_toml), result = folder / "slab.h5", vdb = folder / "fields.vdb";
  ASSERT_EQ(cloudbow({"run", scene, "-o", result, "--quiet", "--set", "output.fields=[\"absorption\",\"actinic\"]",
                      "--set", "domain.vertical_cells=4"})
                .exit_code,
            0);
  const Outcome both = cloudbow({"export", result, "--vdb", vdb, "--actinic", "--absorption"});
  EXPECT_EQ(both.exit_code, 0) << both.errors;
  EXPECT_THAT(both.output, AllOf(HasSubstr("2 grids"), HasSubstr("actinic_flux"), HasSubstr("absorbed_power")));
  EXPECT_THAT(cloudbow({"cloud", "info", vdb}).output + cloudbow({"cloud", "info", vdb}).errors,
              HasSubstr("actinic_flux"));
  EXPECT_EQ(cloudbow({"export", result, "--vdb", vdb, "--actinic", "--quiet"}).output, "");
}

TEST(ExportCommand, RefusesWhatCannotBeExported) {
  const TemporaryFolder folder;
  const auto scene = folder.write("slab.toml", slab_toml), result = folder / "slab.h5", vdb = folder / "x.vdb";
  ASSERT_EQ(cloudbow({"run", scene, "-o", result, "--quiet", "--set", "domain.vertical_cells=4"}).exit_code, 0);
  const auto refused = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"export", result, "--vdb", vdb};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = cloudbow(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(options);
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_FALSE(std::filesystem::exists(vdb));
    return outcome.errors;
  };
  EXPECT_THAT(refused({}), HasSubstr("nothing to export"));
  EXPECT_THAT(refused({"--actinic"}), HasSubstr("actinic"));
  EXPECT_THAT(refused({"--zenith-deg", "190"}), HasSubstr("allowed: 0 to 180"));
  EXPECT_THAT(refused({"--zenith-deg", "10"}), HasSubstr("radiance_field"));
}

}  // namespace
}  // namespace cloudbow
