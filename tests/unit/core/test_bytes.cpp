// Truth: the values that were written.
#include <gtest/gtest.h>

#include <limits>

#include "cloudbow/core/bytes.hpp"

namespace cloudbow {
namespace {

struct Inner {
  std::string name;
  std::vector<double> values;

  bool operator==(const Inner&) const = default;
};

template <class Archive>
void visit_members(Archive& archive, Inner& inner) {
  archive(inner.name, inner.values);
}

TEST(Bytes, ValuesComeBack) {
  const std::vector<Inner> many{{"a", {1, std::numeric_limits<double>::infinity()}}, {"", {}}};
  const std::optional<double> some = 3, none;
  ByteWriter writer;
  writer(7, many, some, none, std::string("text"));
  const std::vector<std::byte> bytes = writer.take();
  ByteReader reader(bytes);
  int number = 0;
  std::vector<Inner> read;
  std::optional<double> read_some, read_none = 5;
  std::string text;
  reader(number, read, read_some, read_none, text);
  EXPECT_EQ(number, 7);
  EXPECT_EQ(read, many);
  EXPECT_EQ(read_some, some);
  EXPECT_EQ(read_none, none);
  EXPECT_EQ(text, "text");
  EXPECT_THROW(reader(number), InputError);
}

TEST(Bytes, ATruthValueIsOneOfTwo) {
  bool value = false;
  const std::array<std::byte, 3> bytes{std::byte{0}, std::byte{1}, std::byte{2}};
  for (const bool truth : {false, true}) {
    ByteReader(std::span(bytes).subspan(truth ? 1 : 0, 1))(value);
    EXPECT_EQ(value, truth);
  }
  EXPECT_THROW(ByteReader{std::span(bytes).last(1)}(value), InputError);
}

TEST(Bytes, AnEarlyEndIsRefusedBeforeMemoryIsTaken) {
  ByteWriter writer;
  writer(std::numeric_limits<std::size_t>::max() / 16);
  const std::vector<std::byte> bytes = writer.take();
  std::vector<double> values;
  EXPECT_THROW(ByteReader{bytes}(values), InputError);
  std::string text;
  EXPECT_THROW(ByteReader{bytes}(text), InputError);
}

}  // namespace
}  // namespace cloudbow
