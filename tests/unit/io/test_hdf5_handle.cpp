// Functions that readers and writers of HDF5 share. Truth: the data that HDF5 itself was given to write.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "io/hdf5_handle.hpp"

namespace cloudbow::hdf5 {
namespace {

class Hdf5Handle : public testing::Test {
 protected:
  Hdf5Handle()
      : path_(std::filesystem::path(testing::TempDir()) / ("cloudbow_hdf5_" + std::to_string(getpid()))),
        file_(create_file(path_)) {}
  ~Hdf5Handle() override {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }

  Handle make(const char* name, const std::vector<hsize_t>& shape, hid_t type = H5T_IEEE_F32LE) {
    const Handle space = dataspace(shape);
    return {H5Dcreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose, "create"};
  }
  /// 2 x 3 x 4 numbers: 100 k + 10 j + i.
  Handle make_numbers() {
    Handle dataset = make("numbers", {2, 3, 4});
    std::vector<float> value;
    for (int n = 0; n < 24; ++n) value.push_back(static_cast<float>(100 * (n / 12) + 10 * (n / 4 % 3) + n % 4));
    check(H5Dwrite(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()), "write");
    return dataset;
  }

  std::filesystem::path path_;
  Handle file_;
};

TEST_F(Hdf5Handle, ShapesAndSizes) {
  const Handle numbers = make_numbers();
  EXPECT_EQ(shape_of(numbers), (std::vector<hsize_t>{2, 3, 4}));
  EXPECT_EQ(value_count(numbers), 24U);
  EXPECT_EQ(value_bytes(numbers), 4U);
  const Handle one = make("one", {}, H5T_STD_I64LE);
  EXPECT_TRUE(shape_of(one).empty());
  EXPECT_EQ(value_count(one), 1U);
  EXPECT_EQ(value_bytes(one), 8U);
}

TEST_F(Hdf5Handle, AllValuesInAnyNumber) {
  const Handle numbers = make_numbers();
  const auto real = read_all<double>(numbers);
  ASSERT_EQ(real.size(), 24U);
  EXPECT_EQ(real[23], 123);
  EXPECT_EQ(read_all<std::int32_t>(numbers)[13], 101);
  EXPECT_TRUE(read_all<float>(make("none", {0, 3})).empty());
}

TEST_F(Hdf5Handle, BlocksAreReadAndWritten) {
  const Handle numbers = make_numbers();
  EXPECT_EQ(read_block<double>(numbers, {{1, 0, 2}, {1, 3, 2}}), (std::vector<double>{102, 103, 112, 113, 122, 123}));
  const std::vector<double> row{-1, -2, -3, -4};
  write_block(numbers, {{0, 1, 0}, {1, 1, 4}}, H5T_NATIVE_DOUBLE, row.data());
  EXPECT_EQ(read_block<float>(numbers, {{0, 0, 3}, {1, 3, 1}}), (std::vector<float>{3, -4, 23}));
  EXPECT_THROW(read_block<float>(numbers, {{0, 0, 3}, {1, 3, 2}}), Error);  // beyond the end
}

TEST_F(Hdf5Handle, ABlockLargerThanMemoryIsAnError) {
  const hsize_t half = hsize_t{1} << 33;
  EXPECT_EQ((Block{{0, 0}, {half, 4}}.values()), half * 4);
  EXPECT_EQ((Block{{0, 0}, {half, 0}}.values()), 0U);
  EXPECT_THROW((void)(Block{{0, 0}, {half, half}}.values()), Error);
}

TEST_F(Hdf5Handle, MembersByNameOrAge) {
  for (const char* name : {"z", "a", "m"}) make(name, {1});
  EXPECT_EQ(member_names(file_, H5_INDEX_NAME), (std::vector<std::string>{"a", "m", "z"}));
  EXPECT_EQ(member_names(file_, H5_INDEX_CRT_ORDER), (std::vector<std::string>{"z", "a", "m"}));
  EXPECT_TRUE(exists(file_, "a"));
  EXPECT_FALSE(exists(file_, "b"));
  EXPECT_THROW(open_dataset(file_, "b"), Error);
  EXPECT_THROW(open_group(file_, "a"), Error);
}

TEST_F(Hdf5Handle, AttributesOfOneValueHoldOne) {
  const auto write = [this](const char* name, const std::vector<double>& value) {
    const Handle space = dataspace({value.size()});
    const Handle attribute(H5Acreate2(file_, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "make");
    check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, value.data()), "write");
  };
  write("one", {2.5});
  write("two", {1, 2});
  EXPECT_TRUE(has_attribute(file_, "one"));
  EXPECT_EQ(attribute_number(file_, "one"), 2.5);
  EXPECT_EQ(attribute_integer(file_, "one"), 2);
  EXPECT_EQ(attribute_numbers(file_, "two"), (std::vector<double>{1, 2}));
  EXPECT_THROW(attribute_number(file_, "two"), Error);
  EXPECT_THROW(attribute_text(file_, "one"), Error);
  EXPECT_THROW(attribute_number(file_, "three"), Error);
}

TEST_F(Hdf5Handle, AFinishedFileIsRead) {
  make_numbers().close();
  finish_file(file_);
  const Handle file = open_file(path_);
  EXPECT_EQ(read_all<float>(open_dataset(file, "numbers"))[5], 11);
}

// HDF5 allocates the size that a chunk states in the file's index, the B-tree of old files: that of no bytes is refused
// by the system's malloc(3).
TEST(Hdf5Chunks, AChunkOfSizeZeroIsNoLackOfMemory) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / ("cloudbow-chunk-" + std::to_string(getpid()) + ".h5");
  {
    const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, "create");
    const Handle creation = property_list(H5P_DATASET_CREATE);
    const hsize_t chunk = 4;
    H5Pset_chunk(creation, 1, &chunk);
    H5Pset_fletcher32(creation);
    const Handle space = dataspace({8});
    const Handle dataset(H5Dcreate2(file, "a", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                         "create");
    const std::vector<double> values(8, 1.);
    write_block(dataset, {{0}, {8}}, H5T_NATIVE_DOUBLE, values.data());
  }
  EXPECT_EQ(read_all<double>(open_dataset(open_file(path), "a")), std::vector<double>(8, 1.));
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  in.close();
  constexpr std::size_t first_key = 24;  // behind name, type, level, count and neighbours of a node
  const auto node = bytes.find(std::string("TREE\x01\x00", 6));
  ASSERT_NE(node, std::string::npos);
  bytes.replace(node + first_key, 4, 4, '\0');
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    read_all<double>(open_dataset(open_file(path), "a"));
    ADD_FAILURE() << "nothing thrown";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "a chunk has the size 0");
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace cloudbow::hdf5
