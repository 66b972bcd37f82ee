// Runs in parts. Truth: the run in one process, as it prints its result. All values of the file are compared by
// tests/robustness/ranks.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../commands/call_cloudbow.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

TEST(Merge, PartsPrintWhatOneRunPrints) {
  const TemporaryFolder folder;
  const auto scene = folder.write(
      "scene.toml",
      "[spectrum]\nwavelengths_um = [0.67, 0.55, 0.5]\n[[layer]]\nbottom_m = 0\ntop_m = 100\noptical_depth = [1, 2, "
      "3]\n"
      "single_scattering_albedo = 0.9\nphase_function = \"isotropic\"\n[sun]\nzenith_deg = 30\nazimuth_deg = 0\n"
      "[solver]\naccuracy = \"draft\"\n");
  const std::vector<std::string> run{"run", scene, "-o", folder / "r.h5"};
  const Outcome whole = cloudbow(run);
  EXPECT_EQ(whole.exit_code, 0) << whole.errors;
  std::vector<std::string> merge{"merge"};
  for (const char* share : {"1/2", "2/2"}) {
    std::vector<std::string> part = run;
    part.insert(part.end(), {"--part", share});
    const Outcome outcome = cloudbow(part);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.output, HasSubstr("cloudbow merge"));
    merge.push_back(folder / (std::string("r.h5.part-") + share[0] + "-of-2"));
  }
  const Outcome merged = cloudbow(merge);
  EXPECT_EQ(merged.exit_code, 0) << merged.errors;
  EXPECT_EQ(lines_of(merged.output, "reflectance").size(), 3U);
  EXPECT_EQ(lines_of(merged.output, "reflectance"), lines_of(whole.output, "reflectance"));
}

TEST(Merge, APartIsNotOverwritten) {
  const TemporaryFolder folder;
  const auto scene = folder.write(
      "scene.toml",
      "[spectrum]\nwavelengths_um = [0.67, 0.55]\n[[layer]]\nbottom_m = 0\ntop_m = 100\noptical_depth = [1, 2]\n"
      "single_scattering_albedo = 0.9\nphase_function = \"isotropic\"\n[sun]\nzenith_deg = 30\nazimuth_deg = 0\n"
      "[solver]\naccuracy = \"draft\"\n");
  EXPECT_EQ(cloudbow({"run", scene, "-o", folder / "r.h5", "--part", "1/1", "--quiet"}).exit_code, 0);
  const std::filesystem::path part = folder / "part.h5";
  std::filesystem::rename(folder / "r.h5.part-1-of-1", part);
  const auto bytes = std::filesystem::file_size(part);
  const Outcome outcome = cloudbow({"merge", part, "-o", part});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("would overwrite an input"));
  EXPECT_EQ(std::filesystem::file_size(part), bytes);
}

TEST(Merge, OtherFilesAreNoParts) {
  const TemporaryFolder folder;
  const Outcome outcome = cloudbow({"merge", folder.write("x.part", std::string(100, 'x'))});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("x.part: can't be read as a part of a run (it begins with other bytes)"));
}

}  // namespace
}  // namespace cloudbow
