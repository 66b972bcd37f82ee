#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "transport/grid/angular_field.hpp"

namespace cloudbow {
namespace {

// IEEE 754 binary16: eleven significant bits from 2^-14 on, steps of 2^-24 below, 65504 at most.
TEST(Halves, HoldElevenBits) {
  constexpr float unit = .25F;
  // More than a vector of lanes, and not a multiple of one: both ways of the kernel.
  std::vector<float> value;
  for (float v = unit * 0x1p-14F; v < unit * 60000; v *= 1.37F) value.push_back(v);
  ASSERT_NE(value.size() % lanes, 0U);
  std::vector<std::uint16_t> packed(value.size());
  std::vector<float> back(value.size());
  store_float16(value.data(), value.size(), unit, 0, packed.data());
  load_float16(packed.data(), packed.size(), unit, back.data());
  for (std::size_t i = 0; i < value.size(); ++i) {
    EXPECT_NEAR(back[i], value[i], 0x1p-10F * value[i]);
    EXPECT_GE(back[i], 0);
  }
}

// 1.0003 lies between float16 values 2^-10 apart. Rounded to the nearest, a thousand would each have an error of a
// fourth of that. Evenly spread rounding leaves the error of a few of them.
TEST(Halves, RoundingKeepsTheMean) {
  for (const std::size_t lone : {std::size_t{0}, std::size_t{7}}) {  // and the way of those that fill no vector
    const std::vector<float> value(1024 + lone, 1.0003F);
    std::vector<std::uint16_t> packed(value.size());
    std::vector<float> back(value.size());
    for (std::size_t first = 0; first<value.size(); first += lone> 0 ? lone : value.size()) {
      const std::size_t n = std::min(value.size() - first, lone > 0 ? lone : value.size());
      store_float16(value.data() + first, n, 1, static_cast<std::uint32_t>(first), packed.data() + first);
    }
    load_float16(packed.data(), packed.size(), 1, back.data());
    const double sum = std::accumulate(back.begin(), back.end(), 0.);
    EXPECT_NEAR(sum, static_cast<double>(value.size()) * 1.0003, 4 * 0x1p-10);
  }
}

TEST(Halves, EndsAreTheLargestNumberAndZero) {
  for (const std::size_t n : {std::size_t{1}, std::size_t{8}}) {  // one by one, and as a vector of lanes
    const std::vector<float> value(n, 1e9F), small(n, 0x1p-26F);
    std::vector<std::uint16_t> packed(n);
    std::vector<float> back(n);
    store_float16(value.data(), n, 2.F, 0, packed.data());
    load_float16(packed.data(), n, 2.F, back.data());
    EXPECT_EQ(back.back(), 2 * 65504.F);
    store_float16(small.data(), n, 2.F, 0, packed.data());
    load_float16(packed.data(), n, 2.F, back.data());
    EXPECT_EQ(back.back(), 0);
    store_float16(small.data(), n, 0x1p-10F, 0, packed.data());
    load_float16(packed.data(), n, 0x1p-10F, back.data());
    EXPECT_EQ(back.back(), small.back());
  }
}

TEST(Halves, PowersOfTwoAndSmallWholesAreKept) {
  std::vector<float> value(2049);
  std::iota(value.begin(), value.end(), 0.F);
  std::vector<std::uint16_t> packed(value.size());
  std::vector<float> back(value.size());
  store_float16(value.data(), value.size(), 1, 7, packed.data());
  load_float16(packed.data(), value.size(), 1, back.data());
  EXPECT_EQ(back, value);
}

TEST(AngularField, PackedRowsReadWhatWasStored) {
  constexpr std::size_t cells = 100;
  AngularField<float> field(3, cells, 1.F);
  ASSERT_TRUE(field.packed());
  std::vector<float> value(cells), room(cells);
  std::iota(value.begin(), value.end(), 1.F);
  field.store(1, 0, cells, value.data());
  field.set_rows(5);
  for (int d = 0; d < 5; ++d) {
    const float* const row = field.stored_row(d).read(10, 50, room.data());
    for (std::size_t c = 0; c < 50; ++c) EXPECT_EQ(row[c], d == 1 ? value[10 + c] : 0.F);
  }
  AngularField<float> plain(2, cells);
  EXPECT_FALSE(plain.packed());
  EXPECT_EQ(plain.stored_row(1).read(7, 3, room.data()), plain.row(1) + 7) << "a plain row is read where it is";
}

}  // namespace
}  // namespace cloudbow
