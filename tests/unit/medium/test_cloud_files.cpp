// Grids of cloud files, kept. Truth: the data written, and that nothing is read when the file is gone.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/cloud_files.hpp"

namespace cloudbow {
namespace {

class CloudFilesTest : public testing::Test {
 protected:
  CloudFilesTest()
      : path_(std::filesystem::path(testing::TempDir()) / ("cloudbow_files_" + std::to_string(getpid()) + ".vdb")) {
    write_cloud_vdb(path_, make_cloud_field({2, 1, 1}, {10, 10, 10}, {0, 0, 0}, {0.5F, 0.25F}, "extinction"));
  }
  ~CloudFilesTest() override { remove(); }
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }

  std::filesystem::path path_;
};

TEST_F(CloudFilesTest, KeptGridsNeedNoFile) {
  CloudFiles files(true);
  const CloudField field = files.field(path_, {});
  EXPECT_EQ(field.value, (std::vector<float>{0.5F, 0.25F}));
  const std::vector<float> auxiliary = files.auxiliary(path_, field, {}, 0, 1);
  VdbReadOptions doubled;
  doubled.scale = 2;
  EXPECT_EQ(files.field(path_, doubled).value, (std::vector<float>{1, 0.5F}));  // another scale is another grid
  remove();
  EXPECT_EQ(files.field(path_, {}).value, field.value);
  EXPECT_EQ(files.field(path_, doubled).value, (std::vector<float>{1, 0.5F}));
  EXPECT_EQ(files.auxiliary(path_, field, {}, 0, 1), auxiliary);
  EXPECT_THROW(files.auxiliary(path_, field, {}, 0, 2), InputError);  // never read with these bounds
}

// Two fields of one file, with different voxels, have different values of one auxiliary grid.
TEST_F(CloudFilesTest, AuxiliaryValuesBelongToAField) {
  const CloudField field = make_cloud_field({2, 1, 1}, {10, 10, 10}, {0, 0, 0}, {0.5F, 0.25F}, "extinction");
  write_cloud_vdb(path_, field, {}, {{"T", "temperature", "K", {270, 260}}});
  const CloudField right = make_cloud_field({2, 1, 1}, {10, 10, 10}, {0, 0, 0}, {0, 0.25F}, "extinction");
  VdbReadOptions temperature;
  temperature.grid = "T";
  CloudFiles files(true);
  EXPECT_EQ(files.auxiliary(path_, field, temperature, 0, 400), (std::vector<float>{270, 260}));
  EXPECT_EQ(files.auxiliary(path_, right, temperature, 0, 400), (std::vector<float>{260}));
}

TEST_F(CloudFilesTest, TwoFilesAreTwo) {
  const std::filesystem::path other = path_.string() + ".other.vdb";
  write_cloud_vdb(other, make_cloud_field({1, 1, 1}, {10, 10, 10}, {0, 0, 0}, {2}, "extinction"));
  CloudFiles files(true);
  EXPECT_EQ(files.field(path_, {}).value, (std::vector<float>{0.5F, 0.25F}));
  EXPECT_EQ(files.field(other, {}).value, (std::vector<float>{2}));
  std::filesystem::remove(other);
}

TEST_F(CloudFilesTest, WithoutKeepingEachIsReadAnew) {
  CloudFiles files(false);
  files.field(path_, {});
  remove();
  EXPECT_THROW(files.field(path_, {}), InputError);
}

TEST_F(CloudFilesTest, ASentenceIsReportedOnce) {
  std::vector<std::string> told;
  CloudFiles files(true, [&told](const std::string& sentence) { told.push_back(sentence); });
  for (const char* sentence : {"a", "b", "a"}) files.note(sentence);
  EXPECT_EQ(told, (std::vector<std::string>{"a", "b"}));
  CloudFiles(true).note("nobody listens");
}

}  // namespace
}  // namespace cloudbow
