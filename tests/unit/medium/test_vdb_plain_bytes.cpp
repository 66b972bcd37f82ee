// Bytes of a file, none beyond its end. Truth: the bytes that were written.
#include "medium/vdb_plain_bytes.hpp"
#include "vdb_test_tools.hpp"

namespace cloudbow {
namespace {

TEST_F(VdbFile, NumbersAndTextsAreReadInTheirOrder) {
  std::ofstream(file(), std::ios::binary) << std::string(
      "\x02\x01\x00\x00\x03\x00\x00\x00"
      "abc\x01\x07",
      13);
  PlainBytes bytes(file());
  EXPECT_EQ(bytes.size(), 13U);
  EXPECT_EQ(bytes.number<std::int32_t>(), 258);
  EXPECT_EQ(bytes.text(), "abc");
  EXPECT_TRUE(bytes.flag());
  EXPECT_EQ(bytes.position(), 12U);
  EXPECT_EQ(bytes.left(), 1U);
  EXPECT_THROW(bytes.flag(), NotPlain);  // 7 is neither
  bytes.move_to(4);
  EXPECT_EQ(bytes.text(), "abc");
}

TEST_F(VdbFile, NothingIsReadBeyondTheEnd) {
  std::ofstream(file(), std::ios::binary) << std::string(
      "\xff\xff\xff\xff"
      "ab",
      6);
  PlainBytes bytes(file());
  EXPECT_THROW(bytes.text(), NotPlain);  // of 4 GB
  EXPECT_THROW(bytes.number<std::int32_t>(), NotPlain);
  EXPECT_EQ(bytes.number<std::uint8_t>(), 'a');
  EXPECT_THROW(bytes.move_to(7), NotPlain);
  bytes.move_to(6);
  EXPECT_THROW(bytes.number<std::uint8_t>(), NotPlain);
}

TEST_F(VdbFile, FilesThatCannotBeReadAreNotPlain) {
  EXPECT_THROW(PlainBytes{file("none.vdb")}, NotPlain);
  EXPECT_THROW(PlainBytes{folder_}, NotPlain);
}

}  // namespace
}  // namespace cloudbow
