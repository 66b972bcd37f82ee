#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/checkpoint_file.hpp"

namespace cloudbow {
namespace {

struct State {
  std::vector<std::uint16_t> float16{0, 1, 0x7bff, 0x8001};
  std::vector<std::vector<float>> rows{{1.5F, -2.F, 1e-38F}, {3.F, 4.F, 5.F}};
  std::vector<double> numbers{1. / 3, -0., 1e300};
  std::vector<float> large = std::vector<float>(300000, 7.F);  // several chunks

  std::vector<StateArray> arrays() {
    return {{"halves", 2, float16.size(), {float16.data()}},
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
  other.float16.assign(4, 9);
  other.rows.assign(2, std::vector<float>(3));
  other.numbers.assign(3, 0);
  other.large.assign(300000, 0);
  for (const StateArray& array : other.arrays()) input.load(array);
  EXPECT_EQ(other.float16, state_.float16);
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

TEST_F(CheckpointFile, NumbersThatAreNotFiniteAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refused = [this](const StateArray& array, const char* row) {
    write_checkpoint(path_, "cloudbow test", key_, state_.arrays());
    const std::string message = message_of_load(array);
    EXPECT_NE(message.find(array.name + ": row " + row), std::string::npos) << message;
    EXPECT_NE(message.find("not finite"), std::string::npos) << message;
    state_ = State();
  };
  state_.float16[2] = 0x7c00;  // infinity
  refused(state_.arrays()[0], "0");
  state_.float16[2] = 0xfe01;  // not a number
  refused(state_.arrays()[0], "0");
  state_.rows[1][2] = nan;
  refused(state_.arrays()[1], "1");
  state_.numbers[0] = -infinity;
  refused(state_.arrays()[2], "0");
  large_at(200000) = nan;
  refused(state_.arrays()[3], "0");
}

/// Opens the checkpoint with the HDF5 library itself and spoils it.
class SpoiledCheckpoint : public CheckpointFile {
 protected:
  std::string message_after(const std::function<void(hid_t)>& spoil) {
    const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    spoil(file);
    EXPECT_GE(H5Fclose(file), 0);
    try {
      CheckpointInput input(path_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(SpoiledCheckpoint, SeveralValuesInPlaceOfOneAreRefused) {
  for (const char* name : {"checkpoint_format", "layout", "problem", "source"}) {
    write_checkpoint(path_, "cloudbow test", key_, state_.arrays());
    const std::string message = message_after([name](hid_t file) {
      const hid_t older = H5Aopen(file, name, H5P_DEFAULT), type = H5Aget_type(older);
      H5Aclose(older);
      H5Adelete(file, name);
      const hsize_t count = 4;
      const hid_t space = H5Screate_simple(1, &count, nullptr);
      H5Aclose(H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
      H5Sclose(space);
      H5Tclose(type);
    });
    EXPECT_NE(message.find(std::string("attribute ") + name + " has 4 values"), std::string::npos) << message;
  }
}

TEST_F(SpoiledCheckpoint, AnotherFormatIsOfAnotherVersion) {
  // Format 1 had keys by another hash, format 2 no slopes of light, 3 no power of the ledger, 4 another number more; 6
  // is of the future.
  for (const std::int32_t format : {1, 2, 3, 4, 6}) {
    write_checkpoint(path_, "cloudbow test", key_, state_.arrays());
    const std::string message = message_after([format](hid_t file) {
      const hid_t attribute = H5Aopen(file, "checkpoint_format", H5P_DEFAULT);
      H5Awrite(attribute, H5T_NATIVE_INT32, &format);
      H5Aclose(attribute);
    });
    EXPECT_NE(message.find(path_.string() + ": is a checkpoint of another version (found format " +
                           std::to_string(format) + " by cloudbow test, allowed format 5)"),
              std::string::npos)
        << message;
    EXPECT_EQ(message.find("damaged"), std::string::npos) << message;
  }
}

TEST_F(SpoiledCheckpoint, ValuesAreReadInTheChildFirst) {
  // More than its file can hold: HDF5 would fill unwritten data with zeros.
  const std::string message = message_after([](hid_t file) {
    H5Ldelete(file, "large", H5P_DEFAULT);
    const hsize_t shape[2] = {1, hsize_t{1} << 40}, chunk[2] = {1, 1024};
    const hid_t space = H5Screate_simple(2, shape, nullptr), properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 2, chunk);
    H5Dclose(H5Dcreate2(file, "large", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    H5Pclose(properties);
    H5Sclose(space);
  });
  EXPECT_NE(message.find("large is larger than its file"), std::string::npos) << message;
}

TEST_F(SpoiledCheckpoint, ALinkElsewhereIsRefused) {
  const std::string message = message_after([](hid_t file) {
    H5Ldelete(file, "large", H5P_DEFAULT);
    H5Lcreate_external("/dev/zero", "/large", file, "large", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_NE(message.find("a link to another file"), std::string::npos) << message;
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
