#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/results/checkpoint_file.hpp"

namespace cloudbow {
namespace {

struct State {
  std::vector<std::uint16_t> halves{0, 1, 0x7bff, 0x8001};
  std::vector<std::vector<float>> rows{{1.5F, -2.F, 1e-38F}, {3.F, 4.F, 5.F}};
  std::vector<double> numbers{1. / 3, -0., 1e300};
  std::vector<float> large = std::vector<float>(300000, 7.F);  // several chunks

  std::vector<StateArray> arrays() {
    return {{"halves", 2, halves.size(), {halves.data()}},
            {"rows", 4, 3, {rows[0].data(), rows[1].data()}},
            {"numbers", 8, numbers.size(), {numbers.data()}},
            {"large", 4, large.size(), {large.data()}}};
  }
};

class CheckpointFile : public testing::Test {
 protected:
  CheckpointFile()
      : path_(std::filesystem::path(testing::TempDir()) / ("cloudbow_checkpoint_" + std::to_string(getpid()))) {
    large_at(0) = 1.F;
    large_at(299999) = 2.F;
    write_checkpoint(path_, "cloudbow test", key_, state_.arrays());
  }
  ~CheckpointFile() override {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  float& large_at(std::size_t n) { return state_.large[n]; }

  std::string message_of_load(const StateArray& array) {
    try {
      CheckpointInput(path_).load(array);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path path_;
  StateKey key_{0xfedcba9876543210U, 42};
  State state_;
};

TEST_F(CheckpointFile, WhatIsWrittenIsRead) {
  const CheckpointInput input(path_);
  EXPECT_EQ(input.key(), key_);
  EXPECT_EQ(input.source(), "cloudbow test");
  State other;
  other.halves.assign(4, 9);
  other.rows.assign(2, std::vector<float>(3));
  other.numbers.assign(3, 0);
  other.large.assign(300000, 0);
  for (const StateArray& array : other.arrays()) input.load(array);
  EXPECT_EQ(other.halves, state_.halves);
  EXPECT_EQ(other.rows, state_.rows);
  EXPECT_EQ(other.numbers, state_.numbers);
  EXPECT_EQ(other.large, state_.large);
}

TEST_F(CheckpointFile, WhatIsNotThereIsRefused) {
  std::vector<float> values(4);
  for (const StateArray& array : std::vector<StateArray>{{"none", 4, 4, {values.data()}},
                                                         {"numbers", 8, 2, {values.data()}},
                                                         {"numbers", 4, 3, {values.data()}},
                                                         {"rows", 4, 3, {values.data()}}}) {
    const std::string message = message_of_load(array);
    EXPECT_NE(message.find(path_.string()), std::string::npos) << message;
    EXPECT_NE(message.find("checkpoint"), std::string::npos) << message;
  }
}

TEST_F(CheckpointFile, AChangedBitIsSeen) {
  std::ifstream in(path_, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  in.close();
  const std::vector<float> sevens(64, 7.F);  // amid the large array
  const std::string pattern(reinterpret_cast<const char*>(sevens.data()), sizeof(float) * sevens.size());
  const std::size_t at = bytes.find(pattern);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 100] = static_cast<char>(bytes[at + 100] ^ 4);
  std::ofstream(path_, std::ios::binary) << bytes;
  std::vector<float> large(300000);
  EXPECT_NE(message_of_load({"large", 4, large.size(), {large.data()}}), "");
}

TEST_F(CheckpointFile, OtherFilesAreRefused) {
  EXPECT_THROW(CheckpointInput("/nowhere/none"), InputError);
  EXPECT_THROW(CheckpointInput{testing::TempDir()}, InputError);
  for (const std::string& text : {std::string(), std::string("no HDF5"), std::string(4096, '\0')}) {
    std::ofstream(path_, std::ios::binary) << text;
    EXPECT_THROW(CheckpointInput{path_}, InputError);
  }
  EXPECT_THROW(write_checkpoint("/nowhere/none", "cloudbow test", key_, state_.arrays()), InputError);
}

}  // namespace
}  // namespace cloudbow
