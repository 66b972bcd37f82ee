// `cloudbow render`. Truth: the options that its help states.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "call_cloudbow.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

TEST(RenderCommand, DrawsWhatItsOptionsSay) {
  const TemporaryFolder folder;
  ASSERT_EQ(cloudbow({"cloud", "make", "sphere", "--cells", "6", "6", "6", "--voxel-size-m", "50", "50", "50", "-o",
                      folder / "sphere.vdb"})
                .exit_code,
            0);
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

}  // namespace
}  // namespace cloudbow
