// Names in headers of classic netCDF. Truth: headers made by netCDF's "File Format Specifications".
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

#include "les_test_tools.hpp"
#include "medium/classic_header.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;

/// Bytes of names.
struct Header {
  int version = 1;
  std::size_t dimension = 1, attribute = 1, of_variable = 1, variable = 1;
};

/// A file with one dimension, one global attribute, and two variables of two doubles.
class FileOf {
 public:
  explicit FileOf(const Header& header) : header_(header) {}

  std::string text() {
    bytes_ = std::string("CDF") + static_cast<char>(header_.version);
    count(0);
    list(10, 1);
    name(header_.dimension);
    count(2);
    list(12, 1);
    name(header_.attribute);
    number(3, 4);  // three numbers of two bytes, and two bytes of padding
    count(3);
    bytes_ += std::string(8, '\1');
    list(11, 2);
    std::size_t data = begin;
    for (const std::size_t length : {std::size_t{5}, header_.variable}) {
      name(length);
      count(1);
      count(0);
      list(12, 1);
      name(header_.of_variable);
      number(2, 4);
      count(5);
      bytes_ += std::string("m s-1\0\0\0", 8);
      number(6, 4);
      count(16);
      number(data, header_.version == 1 ? 4 : 8);
      data += 16;
    }
    return bytes_.size() > begin ? bytes_ : bytes_ + std::string(begin - bytes_.size() + 32, '\0');
  }

 private:
  static constexpr std::size_t begin = 8192;

  void number(std::uint64_t value, int bytes) {
    for (int n = bytes - 1; n >= 0; --n) bytes_ += static_cast<char>(value >> 8 * n & 255);
  }
  void count(std::uint64_t value) { number(value, header_.version == 5 ? 8 : 4); }
  void list(std::uint64_t kind, std::uint64_t length) {
    number(kind, 4);
    count(length);
  }
  void name(std::size_t length) {
    count(length);
    bytes_ += std::string(length, static_cast<char>('a' + length % 26)) + std::string((4 - length % 4) % 4, '\0');
  }

  const Header header_;
  std::string bytes_;
};

std::uint64_t longest(const Header& header) {
  std::istringstream stream(FileOf(header).text());
  return longest_classic_name(stream);
}

TEST(ClassicHeader, TheLongestNameOfEachKindIsFound) {
  for (const int version : {1, 2, 5}) {
    EXPECT_EQ(longest({.version = version}), 5u);
    for (const std::size_t length : {std::size_t{6}, std::size_t{257}, std::size_t{1280}}) {
      EXPECT_EQ(longest({.version = version, .dimension = length}), length);
      EXPECT_EQ(longest({.version = version, .attribute = length}), length);
      EXPECT_EQ(longest({.version = version, .of_variable = length}), length);
      EXPECT_EQ(longest({.version = version, .variable = length}), length);
    }
  }
}

TEST(ClassicHeader, WhatIsNoneHasNoNames) {
  for (const std::string& text :
       {std::string(), std::string("CD"), std::string("CDF\3aaaaaaaaaaaaaaaa"), std::string("\x89HDF")}) {
    std::istringstream stream(text);
    EXPECT_EQ(longest_classic_name(stream), 0u);
  }
  const std::string whole = FileOf({.variable = 100}).text();
  for (std::size_t length = 0; length < 400; ++length) {
    std::istringstream stream(whole.substr(0, length));
    EXPECT_LE(longest_classic_name(stream), 100u);
  }
}

// The library wrote beyond the buffers of names.
TEST_F(LesImport, NamesThatTheLibraryHasNoRoomForAreRefused) {
  CloudImportOptions options = with([](NetcdfBuilder&) {});
  for (const std::size_t length : {std::size_t{256}, std::size_t{257}, std::size_t{3000}}) {
    std::ofstream(options.file, std::ios::binary) << FileOf({.version = 2, .dimension = length}).text();
    EXPECT_THAT(error_of(options),
                HasSubstr(length == 256 ? "no variable of liquid water"
                                        : "a name in its header is too long (found " + std::to_string(length)));
  }
}

}  // namespace
}  // namespace cloudbow
