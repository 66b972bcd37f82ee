// Arrays of NumPy. Truth: the numbers of the arrays, whatever their type and order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "import_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

TEST_F(CloudImport, ArraysOfNumpy) {
  // Files as numpy.save writes them: the header is padded so that numbers begin at a multiple of 64 bytes.
  const auto array = [&](const std::string& type, const std::string& order, const std::string& shape,
                         const std::string& numbers) {
    std::string head = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': (" + shape + "), }";
    head.resize(117, ' ');
    return options_for(write("a.npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + head + "\n" + numbers));
  };
  const auto bytes_of = [](const auto& values, bool reversed = false) {
    std::string bytes;
    for (const auto value : values) {
      std::string one(reinterpret_cast<const char*>(&value), sizeof value);
      if (reversed) std::reverse(one.begin(), one.end());
      bytes += one;
    }
    return bytes;
  };
  const std::vector<double> numbers{1, 2, 3, 4, 5, 6};  // [z][y][x], 3 x 1 x 2
  const std::vector<double> by_columns{1, 3, 5, 2, 4, 6};
  const std::vector<float> single{1, 2, 3, 4, 5, 6};
  EXPECT_THAT(message_of([&] { import_cloud(array("<f8", "False", "3, 1, 2", bytes_of(numbers))); }),
              HasSubstr("--voxel-size-m DX DY DZ"));
  const auto expect_read = [&](CloudImportOptions options) {
    options.voxel_size_m = {10, 20, 30};
    options.quantity = "liquid_water_content";
    const CloudField found = import_cloud(options).field;
    EXPECT_EQ(found.cells, (std::array<int, 3>{2, 1, 3}));
    EXPECT_EQ(found.quantity, "liquid_water_content");
    EXPECT_THAT(found.value, testing::ElementsAre(1, 2, 3, 4, 5, 6));
  };
  expect_read(array("<f8", "False", "3, 1, 2", bytes_of(numbers)));
  expect_read(array("<f8", "True", "3, 1, 2", bytes_of(by_columns)));
  expect_read(array("<f4", "False", "3, 2", bytes_of(single)));
  expect_read(array(">f4", "False", "3, 2", bytes_of(single, true)));
  const auto error = [&](CloudImportOptions options) {
    options.voxel_size_m = {10, 20, 30};
    return message_of([&] { import_cloud(options); });
  };
  EXPECT_THAT(error(array("<f8", "False", "3, 1, 3", bytes_of(numbers))), HasSubstr("the file is cut off"));
  EXPECT_THAT(error(array("<i8", "False", "3, 1, 2", bytes_of(numbers))), HasSubstr("numbers of type <i8"));
  EXPECT_THAT(error(array("<f8", "False", "3, 1, 2, 1", bytes_of(numbers))), HasSubstr("4 dimensions"));
  EXPECT_THAT(error(array("<f8", "False", "-3, 1, 2", bytes_of(numbers))), HasSubstr("no cells"));
  EXPECT_THAT(error(array("<f8", "False", "2", bytes_of(std::vector<double>{1, -1}))),
              HasSubstr("cell (0, 0, 1) has the value -1"));
}

}  // namespace
}  // namespace cloudbow
