#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <vector>

#include "cloudbow/core/digest.hpp"

namespace cloudbow {
namespace {

std::uint64_t digest_of(const std::vector<float>& values) {
  Digest digest;
  digest.add(std::span<const float>(values));
  return digest.value();
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
