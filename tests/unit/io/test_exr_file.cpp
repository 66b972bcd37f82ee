// OpenEXR pictures. Truth: "OpenEXR File Layout": magic number, attributes, a table of offsets, then scan lines whose
// channels are in alphabetical order.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/exr_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

/// Takes numbers and texts from the front of a file.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    text_.assign(std::istreambuf_iterator<char>(stream), {});
  }
  template <class Number>
  Number take() {
    Number number{};
    std::memcpy(&number, text_.data() + at_, sizeof number);
    at_ += sizeof number;
    return number;
  }
  std::string word() {
    std::string text = text_.c_str() + at_;
    at_ += text.size() + 1;
    return text;
  }
  void skip(std::size_t bytes) { at_ += bytes; }
  void go_to(std::size_t at) { at_ = at; }
  std::size_t size() const { return text_.size(); }
  std::size_t at() const { return at_; }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

TEST(ExrFile, HoldsTheNumbersAsTheFormatSays) {
  const TemporaryFolder folder;
  const FloatImage image{2, 3, {{"R", {1, 2, 3, 4, 5, 6}}, {"G", {7, 8, 9, 10, 11, 12}}}};
  write_exr(folder / "a.exr", image);
  Bytes bytes(folder / "a.exr");
  EXPECT_EQ(bytes.take<std::uint32_t>(), 20000630U);
  EXPECT_EQ(bytes.take<std::uint32_t>(), 2U);  // version 2, one part of scan lines
  std::vector<std::string> attributes;
  for (std::string name = bytes.word(); !name.empty(); name = bytes.word()) {
    attributes.push_back(name);
    const std::string type = bytes.word();
    const auto length = bytes.take<std::int32_t>();
    if (name == "compression") {
      EXPECT_EQ(bytes.take<std::uint8_t>(), 0);  // none
    }
    if (name == "dataWindow") {
      EXPECT_EQ(type, "box2i");
      for (const int corner : {0, 0, 1, 2}) EXPECT_EQ(bytes.take<std::int32_t>(), corner);
    }
    if (name != "compression" && name != "dataWindow") bytes.skip(static_cast<std::size_t>(length));
  }
  for (const char* required : {"channels", "compression", "dataWindow", "displayWindow", "lineOrder",
                               "pixelAspectRatio", "screenWindowCenter", "screenWindowWidth"})
    EXPECT_EQ(std::count(attributes.begin(), attributes.end(), required), 1) << required;
  const std::size_t table = bytes.at();
  for (int row = 0; row < 3; ++row) {
    bytes.go_to(table + 8 * static_cast<std::size_t>(row));
    bytes.go_to(bytes.take<std::uint64_t>());
    EXPECT_EQ(bytes.take<std::int32_t>(), row);
    EXPECT_EQ(bytes.take<std::int32_t>(), 2 * 2 * 4);
    for (const std::size_t channel : {1U, 0U}) {  // G before R
      for (int column = 0; column < 2; ++column)
        EXPECT_EQ(bytes.take<float>(), image.channel[channel].value[static_cast<std::size_t>(2 * row + column)]);
    }
  }
  EXPECT_EQ(bytes.at(), bytes.size());
}

TEST(ExrFile, ThatCannotBeWrittenIsAnInputError) {
  EXPECT_THROW(write_exr("/nowhere/a.exr", {1, 1, {{"Y", {1}}}}), InputError);
}

}  // namespace
}  // namespace cloudbow
