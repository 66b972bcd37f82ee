// Values of nodes in all their forms. Truth: OpenVDB, which writes and reads them.
#include <openvdb/io/Compression.h>

#include "medium/vdb_plain_values.hpp"
#include "vdb_reader_tools.hpp"

namespace cloudbow {
namespace {

using openvdb::Coord;

TEST(PlainValues, HalvesAreConvertedExactly) {
  for (std::uint32_t bits = 0; bits < 0x10000U; ++bits) {
    openvdb::math::half half;
    half.setBits(static_cast<std::uint16_t>(bits));
    const float truth = half;
    const float found = float_of_half(static_cast<std::uint16_t>(bits));
    if (std::isnan(truth)) {  // processors may change the other bits of NaN
      ASSERT_TRUE(std::isnan(found)) << bits;
      ASSERT_EQ(std::signbit(found), std::signbit(truth)) << bits;
    } else {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(found), std::bit_cast<std::uint32_t>(truth)) << bits;
    }
  }
}

TEST(PlainValues, UnknownFlagsAreNotPlain) {
  EXPECT_THROW(PlainCoding::of_flags(8, false), NotPlain);
  EXPECT_THROW(PlainCoding::of_flags(5, false), NotPlain);  // two compressions
  EXPECT_EQ(PlainCoding::of_flags(4, false).method, PlainCoding::Method::blosc);
}

/// Grids whose inactive values are of all kinds that the format distinguishes.
openvdb::GridPtrVec grids_of_all_kinds(bool half) {
  openvdb::GridPtrVec grids;
  for (const float background : {0.0F, 0.5F}) {
    for (int kind = 0; kind < 7; ++kind) {
      const auto grid = scattered_grid(background, "density" + std::to_string(grids.size()));
      const std::vector<float> inactive[] = {
          {}, {-background}, {0.25F}, {background, -background}, {background, 8.0F}, {3.0F, 8.0F}, {1.0F, 2.0F, 4.0F}};
      std::size_t n = 0;
      if (!inactive[kind].empty()) {
        for (auto value = grid->beginValueOff(); value; ++value) {
          if (value.getDepth() == 3) value.setValue(inactive[kind][n++ % inactive[kind].size()]);
        }
      }
      grid->setSaveFloatAsHalf(half);
      grids.push_back(grid);
    }
  }
  return grids;
}

TEST_F(VdbFile, AllCompressionsAndInactiveValuesAreRead) {
  using namespace openvdb::io;
  for (const bool half : {false, true}) {
    const auto grids = grids_of_all_kinds(half);
    for (const std::uint32_t flags : {+COMPRESS_NONE, +COMPRESS_ZIP, +COMPRESS_BLOSC, +COMPRESS_ACTIVE_MASK,
                                      COMPRESS_ZIP | COMPRESS_ACTIVE_MASK, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK}) {
      SCOPED_TRACE("flags " + std::to_string(flags) + (half ? ", half" : ""));
      File output(file().string());
      output.setCompression(flags);
      output.write(grids);
      output.close();
      for (std::size_t n = 0; n < grids.size(); ++n) {
        expect_same_reading(
            file(), {.grid = grids[n]->getName(), .domain_m = VdbDomain{{-20.5, -20.5, -20.5}, {20.5, 20.5, 20.5}}});
      }
    }
  }
}

TEST_F(VdbFile, NumbersThatAreNoneAreKept) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto grid = scattered_grid(nan);
  grid->tree().setValueOff(Coord(1, 1, 1), std::numeric_limits<float>::infinity());
  grid->tree().setValueOff(Coord(1, 1, 2), -nan);
  grid->tree().setValueOff(Coord(1, 1, 3), -0.0F);
  expect_same_reading(write_seekable({grid}));
  expect_same_reading(write_seekable({scattered_grid(-0.0F)}));
}

}  // namespace
}  // namespace cloudbow
