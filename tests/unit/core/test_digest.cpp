#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "cloudbow/core/digest.hpp"

namespace cloudbow {
namespace {

std::uint64_t digest_of(const std::vector<float>& values) {
  Digest digest;
  digest.add(std::span<const float>(values));
  return digest.value();
}

std::uint64_t digest_of_text(const std::string& text) {
  Digest digest;
  digest.add_bytes(text.data(), text.size());
  return digest.value();
}

// Truth: values of XXH3 with 64 bits and seed 0, as xxhsum -H3 of xxHash 0.8 prints them.
TEST(Digest, IsXxh3) {
  EXPECT_EQ(digest_of_text(""), 0x2d06800538d394c2U);
  EXPECT_EQ(digest_of_text("a"), 0xe6c632b61e964e1fU);
  EXPECT_EQ(digest_of_text("abc"), 0x78af5f94892f3950U);
}

TEST(Digest, DependsNotOnThePieces) {
  std::string text;
  for (int n = 0; n < 5000; ++n) text += static_cast<char>(n * n % 251);
  Digest pieces;
  for (std::size_t at = 0, length = 1; at < text.size(); at += length, length = 2 * length % 509) {
    length = std::min(length, text.size() - at);
    pieces.add_bytes(text.data() + at, length);
    EXPECT_EQ(pieces.value(), digest_of_text(text.substr(0, at + length)));
  }
  EXPECT_EQ(pieces.value(), digest_of_text(text));
}

TEST(Digest, EveryBitAndEveryPlaceCounts) {
  std::set<std::uint64_t> seen;
  std::vector<float> values(5, 1.F);
  seen.insert(digest_of(values));
  EXPECT_EQ(*seen.begin(), digest_of(std::vector<float>(5, 1.F)));
  auto* const bytes = reinterpret_cast<unsigned char*>(values.data());
  for (std::size_t bit = 0; bit < 8 * sizeof(float) * values.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<unsigned char>(1U << bit % 8);
    EXPECT_TRUE(seen.insert(digest_of(values)).second) << bit;
    bytes[bit / 8] ^= static_cast<unsigned char>(1U << bit % 8);
  }
  EXPECT_TRUE(seen.insert(digest_of({2.F, 1.F, 1.F, 1.F, 1.F})).second);
  EXPECT_TRUE(seen.insert(digest_of({1.F, 2.F, 1.F, 1.F, 1.F})).second);
  EXPECT_TRUE(seen.insert(digest_of({1.F, 1.F, 1.F, 1.F})).second);
  EXPECT_TRUE(seen.insert(digest_of({})).second);
}

TEST(Digest, TellsWhereOneArrayEnds) {
  const std::vector<float> one{1, 2, 3}, two{4};
  Digest a, b;
  a.add(std::span<const float>(one).first(2));
  a.add(std::span<const float>(one).last(1));
  b.add(std::span<const float>(one).first(1));
  b.add(std::span<const float>(one).last(2));
  EXPECT_NE(a.value(), b.value());
}

}  // namespace
}  // namespace cloudbow
